"""The Rerun viewer as a process of its own, reachable from this machine only."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from dataclasses import dataclass

from ghc_controller.errors import GhcError
from ghc_controller.ros.stop_signals import restore_stop_signals

LOOPBACK = "127.0.0.1"
START_DEADLINE = 30.0  # [s] wall, until the viewer listens
PAGE_PATIENCE = 60.0  # [s] wall without a browser, after which the page of a finished run ends


class ViewerUnavailable(GhcError):
    """The viewer did not start; the message has its last output."""


@dataclass(frozen=True)
class ViewerProcess:
    """A started viewer."""

    process: subprocess.Popen[bytes]
    url: str  # for the SDK to connect to
    page: str  # to be opened in a browser; empty for a window

    def leave(self) -> None:
        """Keep it until the user closes it: the window, or every browser with its page.

        A served page ends after `PAGE_PATIENCE` without a browser (page_keeper.py).
        """
        if self.page and self.process.poll() is None:
            port = self.url.rpartition(":")[2].partition("/")[0]
            command = [sys.executable, "-m", "ghc_sim_bridge.viewer.page_keeper"]
            subprocess.Popen(
                [*command, str(self.process.pid), port, str(PAGE_PATIENCE)],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
                preexec_fn=restore_stop_signals,
            )

    def end(self) -> None:
        """End a viewer that serves a page; a window stays until the user closes it."""
        if self.page and self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGTERM)


def has_screen() -> bool:
    """Whether a window can be opened here."""
    if sys.platform != "linux":
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def start_viewer(window: bool) -> ViewerProcess:
    """Start a viewer in a window, or one that serves a page for the browser.

    It gets a session of its own, so that Ctrl-C in the terminal does not close it.

    Raises:
        ViewerUnavailable: it ended, or does not listen in time.
    """
    port, page_port = _free_ports(2)
    command = [sys.executable, "-m", "rerun", "--bind", LOOPBACK, "--port", str(port)]
    command += ["--newest-first"]  # for a browser that is opened late
    command += ["--expect-data-soon"] if window else []
    command += [] if window else ["--serve-web", "--web-viewer-port", str(page_port)]
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        preexec_fn=restore_stop_signals,
    )
    url = f"rerun+http://{LOOPBACK}:{port}/proxy"
    page = f"http://{LOOPBACK}:{page_port}/?url={url.replace('+', '%2B')}"
    viewer = ViewerProcess(process, url, "" if window else page)
    for needed in [port] if window else [port, page_port]:
        _wait_until_listening(viewer, needed)
    return viewer


def _wait_until_listening(viewer: ViewerProcess, port: int) -> None:
    deadline = time.monotonic() + START_DEADLINE
    while True:
        with socket.socket() as probe:
            if probe.connect_ex((LOOPBACK, port)) == 0:
                return
        code = viewer.process.poll()
        if code is not None:
            raise ViewerUnavailable(
                f"the Rerun viewer ended with exit code {code}; `python -m rerun` says why"
            )
        if time.monotonic() > deadline:
            os.killpg(viewer.process.pid, signal.SIGTERM)
            raise ViewerUnavailable(
                f"the Rerun viewer did not listen on port {port} within {START_DEADLINE:g} s"
            )
        time.sleep(0.05)


def _free_ports(count: int) -> list[int]:
    """Unused ports of this machine."""
    probes = [socket.socket() for _ in range(count)]
    try:
        for probe in probes:
            probe.bind((LOOPBACK, 0))
        return [int(probe.getsockname()[1]) for probe in probes]
    finally:
        for probe in probes:
            probe.close()
