"""The steps that make `.venv`: the environment itself, and the locked packages in it."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from tools.workspace import checks
from tools.workspace.environment import uv_settings
from tools.workspace.layout import Way
from tools.workspace.stamps import Stamp, key_of
from tools.workspace.step import Step


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
        self._forget_half_installed()
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

    def _forget_half_installed(self) -> None:
        """Drop the metadata of packages whose installation was interrupted: RECORD comes last."""
        for metadata in self.layout.venv.glob("lib/python3*/site-packages/*.dist-info"):
            if not (metadata / "RECORD").exists():
                shutil.rmtree(metadata)

    def _install_prefix_script(self) -> None:
        """Make .venv a prefix that colcon's setup scripts chain to, as they do to /opt/ros."""
        for suffix in ("sh", "bash"):
            shutil.copyfile(self._prefix_script(), self.layout.venv / f"local_setup.{suffix}")
