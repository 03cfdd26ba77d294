"""Fixtures for tests that talk ROS: a domain of one's own, a context, nodes as real processes."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from ghc_sim_bridge.run.processes import NodeProcess

# The message classes read it when they are imported: sizes and types of fields are then checked.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ.setdefault("MPLBACKEND", "Agg")

STOP_PATIENCE = 30.0  # [s] from SIGINT to SIGKILL


@pytest.fixture(scope="session", autouse=True)
def _ros_log_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """ROS writes a log file per process: into the folder of the tests, not the user's home."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_LOG_DIR", str(tmp_path_factory.mktemp("ros_log")))
        yield


@pytest.fixture
def ros_domain_id(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A domain id that no other test or experiment on this machine holds; children inherit it."""
    from ghc_sim_bridge.run.domain import DomainLock

    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    lock = DomainLock()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(lock.id))
    yield lock.id
    lock.release()


@pytest.fixture
def ros_context(ros_domain_id: int) -> Iterator[Any]:
    """An rclpy.Context on the test's own domain; pass it as `context=` to nodes and executors."""
    import rclpy

    context = rclpy.Context()
    rclpy.init(context=context, domain_id=ros_domain_id)
    yield context
    context.try_shutdown()


class RunningNode:
    """An installed executable that runs as a process."""

    def __init__(self, process: NodeProcess) -> None:
        self._process = process

    @property
    def exit_code(self) -> int | None:
        """Exit code; None while it runs, negative: ended by that signal."""
        return self._process.exit_code

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    @property
    def output(self) -> str:
        """All that it printed so far, standard output and standard error."""
        return self._process.log.read_text(encoding="utf-8", errors="replace")

    def send(self, number: signal.Signals) -> None:
        """Send a signal."""
        self._process.send(number)

    def wait(self, timeout: float = STOP_PATIENCE) -> int:
        """Wait for the end [s]; return the exit code, fail the test when it does not come."""
        if not self._process.wait(time.monotonic() + timeout):
            pytest.fail(f"{self._process.name} still runs after {timeout:g} s:\n{self.output}")
        assert self.exit_code is not None
        return self.exit_code

    def wait_for_output(self, text: str, timeout: float = 60.0) -> None:
        """Wait until it printed a text [s]; fail the test when it does not come."""
        deadline = time.monotonic() + timeout
        while text not in self.output:
            if self.exit_code is not None or time.monotonic() > deadline:
                pytest.fail(f"{self._process.name} never printed '{text}':\n{self.output}")
            time.sleep(0.02)

    def stop(self) -> int:
        """End it as Ctrl-C does, by force after a while; return the exit code."""
        self.send(signal.SIGINT)
        if not self._process.wait(time.monotonic() + STOP_PATIENCE):
            self.send(signal.SIGKILL)
            self._process.wait(time.monotonic() + STOP_PATIENCE)
        assert self.exit_code is not None
        return self.exit_code


@pytest.fixture
def start_node(ros_domain_id: int, tmp_path: Path) -> Iterator[Callable[..., RunningNode]]:
    """Start `package executable *arguments` as `ros2 run` would; ended when the test ends."""
    from ghc_sim_bridge.run.executables import find_executable
    from ghc_sim_bridge.run.processes import NodeProcess

    running: list[RunningNode] = []

    def start(package: str, executable: str, *arguments: object) -> RunningNode:
        name = f"{executable}_{len(running)}"
        command = [str(find_executable(package, executable)), *map(str, arguments)]
        node = RunningNode(NodeProcess(name, command, tmp_path / f"{name}.log", os.environ))
        running.append(node)
        return node

    yield start
    for node in running:
        if node.exit_code is None:
            node.stop()
