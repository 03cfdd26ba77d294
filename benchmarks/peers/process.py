"""A side in a separate process."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from benchmarks.peers.problem import PeerProblem
from benchmarks.peers.robots import urdf_file
from tools.workspace.errors import SetupError

_KEPT = ("PATH", "HOME", "LANG")  # of this environment: a peer finds its own libraries


class SideProcess:
    """Starts a worker with the Python of a side, and sends requests."""

    def __init__(self, side: str, python: Path, root: Path, *, foreign: bool) -> None:
        """Start it.

        Args:
            foreign: whether it has an environment of its own.
        """
        environment = dict(os.environ)
        if foreign:
            environment = {name: os.environ[name] for name in _KEPT if name in os.environ}
            environment["PYTHONPATH"] = str(root)
        environment["OMP_NUM_THREADS"] = environment["OPENBLAS_NUM_THREADS"] = "1"
        self._side = side
        self._process = subprocess.Popen(
            [str(python), "-W", "ignore", "-m", "benchmarks.peers.worker", side],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
            cwd=root,
        )

    def __enter__(self) -> SideProcess:
        """Itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()

    def open(self, name: str, file: Path, options: Sequence[str]) -> dict[str, Any]:
        """Prepare a case under a name; returns torques at its states, and facts."""
        urdf = urdf_file(PeerProblem.load(file).robot)
        return self._ask({"open": str(file), "urdf": urdf, "options": list(options), "as": name})

    def run(self, name: str) -> dict[str, Any]:
        """Times [ns] of one step at each state: `wall_ns` and `cpu_ns`."""
        return self._ask({"run": name})

    def _ask(self, request: dict[str, Any]) -> dict[str, Any]:
        pipe_in, pipe_out = self._process.stdin, self._process.stdout
        assert pipe_in is not None
        assert pipe_out is not None
        pipe_in.write(json.dumps(request) + "\n")
        pipe_in.flush()
        line = pipe_out.readline()
        if not line:
            raise SetupError(f"peers: the process of '{self._side}' ended at {request}")
        answer: dict[str, Any] = json.loads(line)
        return answer
