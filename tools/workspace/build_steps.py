"""The steps that build `src/`: messages, and the Python packages with the core."""

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
            environment,
            f"colcon could not build {', '.join(names)}; the whole log: log/latest_build/",
        )


class Messages(ColconBuild):
    """ghc_msgs, and what the wheels lack: type support in C and C++, about a minute."""

    title = f"{MESSAGES} (compiled, about a minute)"

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
        self._colcon(["--cmake-args", *cmake])


class PythonPackages(ColconBuild):
    """The Python packages, installed by symlink: an edit of a Python file takes effect at once.

    The compiled core of the controller is built with them, beside its sources.
    """

    title = "Python packages, and the core of the controller (compiled)"

    def packages(self) -> Sequence[str]:
        return [path.name for path in self.layout.python_packages()]

    def key(self) -> str:
        named = ("setup.py", "setup.cfg", "package.xml")
        files = [path / name for path in self.layout.python_packages() for name in named]
        files += self.layout.core_sources()
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

    def run(self) -> None:
        checks.check_compiler(self.context.machine)
        super().run()

    def make(self) -> None:
        self._colcon([])
