"""The steps of the set-up: each has a key (hash of inputs), outputs, and a way to make them."""

from __future__ import annotations

import os
import re
import shutil
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tools.workspace import checks
from tools.workspace.environment import step_environment, uv_settings
from tools.workspace.errors import SetupError
from tools.workspace.layout import MESSAGES, Layout, Way
from tools.workspace.machine import Machine
from tools.workspace.run import Runner
from tools.workspace.stamps import Stamp, files_below, key_of


@dataclass(frozen=True)
class Context:
    """What every step is given."""

    layout: Layout
    way: Way
    machine: Machine
    run: Runner
    caller: Mapping[str, str]
    asked_python: str | None = None

    def environment(self) -> dict[str, str]:
        return step_environment(self.layout, self.way, self.caller)

    def venv_version(self) -> tuple[int, ...] | None:
        """Version of the virtual environment's Python; None when it is not there or broken."""
        if not os.access(self.layout.python, os.X_OK):
            return None
        try:
            text = (self.layout.venv / "pyvenv.cfg").read_text(encoding="utf-8")
        except OSError:
            return None
        found = re.search(r"^version(?:_info)? *= *(\d+)\.(\d+)\.(\d+)", text, re.MULTILINE)
        return tuple(map(int, found.groups())) if found else None

    def lock(self) -> Path:
        """The lock file that fits the virtual environment."""
        version = self.venv_version()
        if version is None:
            raise SetupError(f"{self.layout.venv} is not a virtual environment: remove it")
        return self.layout.lock(self.way, version)


class Step(ABC):
    """One step; `title` is shown when it runs."""

    title: str

    def __init__(self, context: Context) -> None:
        self.context = context
        self.layout = context.layout

    @abstractmethod
    def key(self) -> str:
        """Hash of the inputs."""

    @abstractmethod
    def stamp(self) -> Stamp: ...

    @abstractmethod
    def outputs(self) -> Sequence[Path]:
        """Some files without which the step has to run again."""

    @abstractmethod
    def make(self) -> None:
        """Make the outputs; may find those of an interrupted run."""

    def is_done(self) -> bool:
        return all(path.exists() for path in self.outputs()) and self.stamp().is_done(self.key())

    def run(self) -> None:
        self.stamp().begin(self.key())
        self.make()
        self.stamp().done(self.key())


class VirtualEnvironment(Step):
    """`.venv`, taken over when one is there that fits."""

    title = "virtual environment"

    def key(self) -> str:
        return key_of([], self.layout.root, self.context.way)

    def stamp(self) -> Stamp:
        return Stamp(self.layout.venv / ".ghc_venv")

    def outputs(self) -> Sequence[Path]:
        return [self.layout.python, self.layout.venv / "pyvenv.cfg"]

    def is_done(self) -> bool:
        return self._fits() and super().is_done()

    def run(self) -> None:
        """Make it, unless a fitting one is there; the stamp lies inside, so it comes last."""
        if not self._may_be_adopted():
            self.make()
        self.stamp().done(self.key())

    def make(self) -> None:
        context = self.context
        checks.check_room(context.machine, self.layout.root)
        python = checks.choose_interpreter(context.machine, context.way, context.asked_python)
        if self.layout.venv.exists():
            shutil.rmtree(self.layout.venv)
        system = ["--system-site-packages"] if context.way is Way.SYSTEM else []
        context.run(
            [python.path, "-m", "venv", *system, str(self.layout.venv)],
            {n: v for n, v in context.environment().items() if n != "VIRTUAL_ENV"},
            f"{python.name} could not make a virtual environment",
        )

    def _fits(self) -> bool:
        """Whether the version is a supported one, and the asked one if one was asked."""
        version = self.context.venv_version()
        if version is None or version[:2] not in checks.SUPPORTED:
            return False
        if not self.context.asked_python:
            return True
        asked = self.context.machine.interpreter(self.context.asked_python)
        return asked is None or asked.version[:2] == version[:2]

    def _may_be_adopted(self) -> bool:
        """A fitting environment without a stamp, made by hand, or with the right one."""
        stamp = self.stamp()
        known = stamp.is_done(self.key())
        made_by_hand = not stamp.exists() and self.context.way is Way.WHEELS
        return self._fits() and (known or made_by_hand)


class Packages(Step):
    """The locked packages.

    Installed, not synchronised: some ROS wheels carry the metadata of a second distribution, which
    `uv pip sync` takes for one that is not in the lock, and removes together with its modules.
    """

    title = "locked packages (0.6 GB to fetch the first time)"

    def key(self) -> str:
        files = [self.context.lock(), self._prefix_script()]
        return key_of(files, self.context.venv_version(), self.layout.root)

    def stamp(self) -> Stamp:
        return Stamp(self.layout.venv / ".ghc_packages")

    def outputs(self) -> Sequence[Path]:
        return [self.layout.python, self._uv()]

    def _uv(self) -> Path:
        return self.layout.venv / "bin" / "uv"

    def _prefix_script(self) -> Path:
        return self.layout.root / "tools" / "wheels_local_setup.sh"

    def make(self) -> None:
        environment = self.context.environment()
        python = str(self.layout.python)
        run = self.context.run
        if not run.succeeds([python, "-m", "pip", "--version"], environment):
            run([python, "-m", "ensurepip"], environment, "pip could not be installed")
        run(
            [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
            + ["--require-hashes", "-r", str(self.layout.uv_lock)],
            environment,
            "uv could not be fetched: is the package index within reach?",
        )
        pip_config = run.output([python, "-m", "pip", "config", "list"], environment)
        run(
            [str(self._uv()), "pip", "install", "--require-hashes"]
            + ["--compile-bytecode", "-r", str(self.context.lock())],
            {**environment, **uv_settings(pip_config, environment)},
            "the locked packages could not be installed",
        )
        if self.context.way is Way.WHEELS:
            self._install_prefix_script()

    def _install_prefix_script(self) -> None:
        """Make .venv a prefix that colcon's setup scripts chain to, as they do to /opt/ros."""
        for suffix in ("sh", "bash"):
            shutil.copyfile(self._prefix_script(), self.layout.venv / f"local_setup.{suffix}")


class Messages(Step):
    """ghc_msgs, by colcon: the only step that compiles, about a minute."""

    title = f"{MESSAGES} (compiled, about a minute)"

    def key(self) -> str:
        files = [*files_below(self.layout.messages()), self.layout.wheel_includes]
        return key_of([*files, self.context.lock()], self.context.venv_version(), self.layout.root)

    def stamp(self) -> Stamp:
        return Stamp(self.layout.build / f".{MESSAGES}_stamp")

    def outputs(self) -> Sequence[Path]:
        share = self.layout.install / MESSAGES / "share"
        return [
            share / "ament_index" / "resource_index" / "packages" / MESSAGES,
            share / MESSAGES / "package.sh",
        ]

    def run(self) -> None:
        checks.check_compiler(self.context.machine)
        if not self.stamp().is_begun(self.key()):
            # Other inputs regenerate nearly all of it anyhow, and what has gone must not stay.
            for base in (self.layout.build, self.layout.install):
                shutil.rmtree(base / MESSAGES, ignore_errors=True)
        super().run()

    def make(self) -> None:
        cmake = ["-DCMAKE_BUILD_TYPE=Release", f"-DPython3_EXECUTABLE={self.layout.python}"]
        if self.context.way is Way.WHEELS:
            cmake += ["-GNinja", f"-DCMAKE_PROJECT_INCLUDE={self.layout.wheel_includes}"]
        _colcon(self.context, [MESSAGES], ["--cmake-args", *cmake])


class PythonPackages(Step):
    """The Python packages, by colcon with symlinks: an edit takes effect at once."""

    title = "Python packages"

    def key(self) -> str:
        named = ("setup.py", "setup.cfg", "package.xml")
        files = [path / name for path in self.layout.python_packages() for name in named]
        return key_of(files, self.context.venv_version(), self.layout.root, self.context.way)

    def stamp(self) -> Stamp:
        return Stamp(self.layout.build / ".python_packages_stamp")

    def outputs(self) -> Sequence[Path]:
        names = [path.name for path in self.layout.python_packages()]
        return [
            self.layout.install / "setup.bash",
            *(self.layout.install / name / "lib" / name for name in names),
            *(self.layout.build / name for name in names),
        ]

    def make(self) -> None:
        _colcon(self.context, [path.name for path in self.layout.python_packages()], [])


def _colcon(context: Context, packages: Sequence[str], more: Sequence[str]) -> None:
    """Build packages by colcon, run by the Python of .venv: installed scripts start with it."""
    layout = context.layout
    environment = context.environment()
    colcon = shutil.which("colcon", path=environment["PATH"])
    if colcon is None:
        raise SetupError("no colcon: `sudo apt install python3-colcon-common-extensions`")
    context.run(
        [str(layout.python), colcon, "build", "--symlink-install"]
        + ["--base-paths", str(layout.source), "--packages-select", *packages, *more],
        environment,
        f"colcon could not build {', '.join(packages)}; the whole log: log/latest_build/",
    )
