"""A step of the set-up: a key (hash of its inputs), outputs, and a way to make them."""

from __future__ import annotations

import os
import re
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tools.workspace.environment import step_environment
from tools.workspace.errors import SetupError
from tools.workspace.layout import Layout, Way
from tools.workspace.machine import Machine
from tools.workspace.run import Runner
from tools.workspace.stamps import Stamp


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
