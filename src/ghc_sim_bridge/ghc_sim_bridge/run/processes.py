"""Starts nodes as processes, monitors them, and ends them in order."""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Self

from ghc_controller.errors import GhcError
from ghc_controller.ros.stop_signals import restore_stop_signals
from ghc_sim_bridge.run.cpu_placement import Cpus
from ghc_sim_bridge.run.executables import find_executable

_TAIL_LINES = 15
_PR_SET_PDEATHSIG = 1  # of linux/prctl.h
_LIBC = ctypes.CDLL(None)  # loaded here, since loading between fork and exec is not safe


class ProcessFailure(GhcError):
    """A node ended unexpectedly."""


class NodeProcess:
    """One node: a process in its own process group, with output to a file."""

    def __init__(
        self,
        name: str,
        command: Sequence[str],
        log: Path,
        environment: Mapping[str, str],
        cpus: Cpus | None = None,
    ) -> None:
        self.name = name
        self.log = log
        with log.open("wb") as output:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env=dict(environment),
                process_group=0,
                preexec_fn=partial(_prepare_child, cpus),
            )

    @property
    def exit_code(self) -> int | None:
        """Exit code; None while the process runs, negative = ended by that signal."""
        return self._process.poll()

    @property
    def pid(self) -> int:
        """Process id of the node, which is started without a shell."""
        return self._process.pid

    def last_lines(self, count: int = _TAIL_LINES) -> str:
        """The end of the node's output."""
        text = self.log.read_text(encoding="utf-8", errors="replace")
        return "\n".join(text.splitlines()[-count:])

    def send(self, number: signal.Signals) -> None:
        """Send a signal to the node's process group, if it is running."""
        if self.exit_code is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._process.pid, number)

    def wait(self, deadline: float) -> bool:
        """Whether the process ended before the deadline (of time.monotonic) [s]."""
        try:
            self._process.wait(max(0.0, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            return False
        return True


class NodeProcesses:
    """The processes of one run; leaving the context ends all running ones."""

    def __init__(
        self,
        folder: Path,
        environment: Mapping[str, str],
        placement: Mapping[str, Cpus] | None = None,
    ) -> None:
        """Logs go to `folder`; `placement` restricts the CPUs of nodes."""
        self._folder = folder
        self._environment = environment
        self._placement = placement or {}
        self._nodes: dict[str, NodeProcess] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self, name: str, package: str, executable: str, arguments: Sequence[str]) -> None:
        """Start one node."""
        path = find_executable(package, executable)
        log = self._folder / f"{name}.log"
        self._nodes[name] = NodeProcess(
            name, [str(path), *arguments], log, self._environment, self._placement.get(name)
        )

    def check(self, may_end: Iterable[str] = ()) -> None:
        """Raise ProcessFailure, with the node's last output, if a node has ended.

        Nodes in `may_end` may exit with code 0.
        """
        for node in self._nodes.values():
            if node.exit_code == 0 and node.name in may_end:
                continue
            if node.exit_code is not None:
                raise ProcessFailure(
                    f"node '{node.name}' ended with {describe_exit(node.exit_code)}; the end of "
                    f"its output ({node.log}):\n{node.last_lines()}"
                )

    def stop(self, names: Iterable[str] | None = None, patience: float = 15.0) -> None:
        """End nodes (all by default) by SIGINT, and by SIGKILL after `patience` [s]."""
        chosen = [self._nodes[name] for name in (self._nodes if names is None else names)]
        for node in chosen:
            node.send(signal.SIGINT)
        deadline = time.monotonic() + patience
        for node in chosen:
            if not node.wait(deadline):
                node.send(signal.SIGKILL)
                node.wait(time.monotonic() + 5.0)

    def log_of(self, name: str) -> Path:
        """Log file of a node."""
        return self._nodes[name].log

    def last_lines(self, name: str) -> str:
        """The end of a node's output."""
        return self._nodes[name].last_lines()

    def pid_of(self, name: str) -> int:
        """Process id of a node."""
        return self._nodes[name].pid

    def exit_codes(self) -> dict[str, int | None]:
        """Exit code per node."""
        return {name: node.exit_code for name, node in self._nodes.items()}


def describe_exit(code: int) -> str:
    """An exit code in words."""
    if code < 0:
        return f"signal {signal.Signals(-code).name}"
    return f"exit code {code}"


def _prepare_child(cpus: Cpus | None) -> None:
    """In the child: restore signal actions, set CPUs, and request a SIGINT when the parent dies,
    so that a killed run leaves no nodes running."""
    restore_stop_signals()
    if sys.platform != "linux":
        return
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGINT)
    if cpus is not None:
        os.sched_setaffinity(0, cpus)
