"""Runs commands; their output goes to the terminal as it comes."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

from tools.workspace.errors import SetupError

_INTERRUPTED = (128 + signal.SIGINT, -signal.SIGINT)  # a command that took note, one that did not


class Runner:
    """Runs commands in the folder of the workspace."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def __call__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        complaint: str,
        log: Path | None = None,
    ) -> None:
        """Run a command; raise SetupError with the complaint when it fails.

        Its output goes to the file `log` if one is given.
        """
        with ExitStack() as stack:
            output = None
            if log is not None:
                log.parent.mkdir(parents=True, exist_ok=True)
                output = stack.enter_context(log.open("wb"))
            code = subprocess.run(
                command,
                env=environment,
                cwd=self._folder,
                check=False,
                stdout=output,
                stderr=output and subprocess.STDOUT,
            ).returncode
        if code in _INTERRUPTED:
            raise KeyboardInterrupt
        if code != 0:
            raise SetupError(f"{complaint} (`{Path(command[0]).name}` ended with {code})")

    def succeeds(self, command: Sequence[str], environment: Mapping[str, str]) -> bool:
        """Whether a command ends well; its output is dropped."""
        run = subprocess.run(
            command, env=environment, cwd=self._folder, check=False, capture_output=True
        )
        return run.returncode == 0

    def output(self, command: Sequence[str], environment: Mapping[str, str]) -> str:
        """What a command prints; empty when it fails."""
        run = subprocess.run(
            command,
            env=environment,
            cwd=self._folder,
            check=False,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        return run.stdout if run.returncode == 0 else ""
