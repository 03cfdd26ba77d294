"""The steps that build `src/`: messages, the core of the controller, and the Python packages."""

from __future__ import annotations

import shutil
from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path

from tools.workspace import checks
from tools.workspace.errors import SetupError
from tools.workspace.layout import MESSAGES, Way
from tools.workspace.stamps import Stamp, files_below, key_of
from tools.workspace.step import Step


class ColconBuild(Step):
    """Some packages of src/, built and installed by colcon."""

    @abstractmethod
    def packages(self) -> Sequence[str]: ...

    def run(self) -> None:
        """Build from scratch, unless the build of the same inputs was interrupted.

        What an earlier build left must not stay: messages and executables that went, links into
        a folder that was moved.
        """
        if not self.stamp().is_begun(self.key()):
            for name in self.packages():
                shutil.rmtree(self.layout.build / name, ignore_errors=True)
                shutil.rmtree(self.layout.install / name, ignore_errors=True)
        super().run()

    def _colcon(self, more: Sequence[str]) -> None:
        """Run colcon by the Python of .venv: the scripts that it installs start with that one."""
        environment = self.context.environment()
        colcon = shutil.which("colcon", path=environment["PATH"])
        if colcon is None:
            raise SetupError("no colcon: `sudo apt install python3-colcon-common-extensions`")
        names = self.packages()
        self.context.run(
            [str(self.layout.python), colcon, "build", "--symlink-install"]
            + ["--base-paths", str(self.layout.source), str(self.layout.wheel_interfaces)]
            + ["--packages-select", *names, *more],
            environment | {"GHC_CORE_BUILD": str(self.layout.core_build)},
            f"colcon could not build {', '.join(names)}; the whole log: log/latest_build/",
        )


class Messages(ColconBuild):
    """ghc_msgs, and what the wheels lack: type support in C, and in C++ for an installation.

    Among the wheels no program in C++ reads messages.
    """

    title = f"{MESSAGES} (compiled)"

    def packages(self) -> Sequence[str]:
        return [path.name for path in self._folders()]

    def _folders(self) -> Sequence[Path]:
        return self.layout.interfaces(self.context.way)

    def key(self) -> str:
        files = [path for folder in self._folders() for path in files_below(folder)]
        files.append(self.layout.wheel_includes)
        return key_of([*files, self.context.lock()], self.context.venv_version(), self.layout.root)

    def stamp(self) -> Stamp:
        return Stamp(self.layout.build / f".{MESSAGES}_stamp")

    def outputs(self) -> Sequence[Path]:
        found: list[Path] = []
        for name in self.packages():
            share = self.layout.install / name / "share"
            found.append(share / "ament_index" / "resource_index" / "packages" / name)
            found.append(share / name / "package.sh")
        return found

    def run(self) -> None:
        checks.check_compiler(self.context.machine)
        super().run()

    def make(self) -> None:
        cmake = ["-DCMAKE_BUILD_TYPE=Release", f"-DPython3_EXECUTABLE={self.layout.python}"]
        if self.context.way is Way.WHEELS:
            cmake += ["-GNinja", f"-DCMAKE_PROJECT_INCLUDE={self.layout.wheel_includes}"]
            cmake += ["-DWITH_CPP=OFF"]
        self._colcon(["--cmake-args", *cmake])


class Core(Step):
    """The compiled core of the controller, beside its sources."""

    title = "core of the controller (compiled)"

    def key(self) -> str:
        files = self.layout.core_sources()
        return key_of(files, self.context.venv_version(), self.layout.root, self.context.way)

    def stamp(self) -> Stamp:
        return Stamp(self.layout.build / ".core_stamp")

    def outputs(self) -> Sequence[Path]:
        return [self.layout.core_build, *self.layout.core_extensions()]

    def run(self) -> None:
        """Build what changed; from scratch for another Python or in a folder that was moved."""
        checks.check_compiler(self.context.machine)
        place = Stamp(self.layout.core_build / ".made_for")
        made_for = key_of([], self.context.venv_version(), self.layout.root, self.context.way)
        if not place.is_done(made_for):
            shutil.rmtree(self.layout.core_build, ignore_errors=True)
            place.done(made_for)
        super().run()

    def make(self) -> None:
        log = self.layout.log / "core.log"
        self.context.run(
            [
                str(self.layout.python),
                str(self.layout.core_builder()),
                str(self.layout.core_build),
            ],
            self.context.environment(),
            "the core of the controller could not be built; the whole log: log/core.log",
            log,
        )


class PythonPackages(ColconBuild):
    """The Python packages, installed by symlink: an edit of a Python file takes effect at once.

    The extension of the core is only linked again.
    """

    title = "Python packages"

    def packages(self) -> Sequence[str]:
        return [path.name for path in self.layout.python_packages()]

    def key(self) -> str:
        named = ("setup.py", "setup.cfg", "package.xml")
        files = [path / name for path in self.layout.python_packages() for name in named]
        return key_of(files, self.context.venv_version(), self.layout.root, self.context.way)

    def stamp(self) -> Stamp:
        return Stamp(self.layout.build / ".python_packages_stamp")

    def outputs(self) -> Sequence[Path]:
        names = self.packages()
        return [
            self.layout.install / "setup.bash",
            *(self.layout.install / name / "lib" / name for name in names),
            *(self.layout.build / name for name in names),
            *self.layout.core_extensions(),
        ]

    def make(self) -> None:
        self._colcon([])
