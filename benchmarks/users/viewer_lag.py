"""How far the page of the live viewer is behind the data, in a browser without a graphics card.

    python -m benchmarks.users.viewer_lag --scene kuka_lwr --seconds 60

The view of a run gets a patch whose color is the number of the frame. Screenshots of the page in
headless Chromium, which draws on the processor, tell which frame is shown.
"""

from __future__ import annotations

import argparse
import io
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from PIL import Image

from benchmarks.models import ROOT
from ghc_sim_bridge import Simulator, load_scene
from ghc_sim_bridge.ros.viewer_node import FRAME_PERIOD
from ghc_sim_bridge.viewer.layout import (
    ALPHA,
    ERRORS,
    TIMELINE,
    TORQUE,
    TORQUE_RATE,
    blueprint,
    new_recording,
)
from ghc_sim_bridge.viewer.live_view import LiveView
from ghc_sim_bridge.viewer.process import start_viewer

sys.path.insert(0, str(ROOT / "test"))
from browser import Browser

_DIGITS = 240  # [-] of green; red counts beyond, blue is the complement of green
_RED = 200
_TASKS = ("end_effector", "elbow", "posture")


class Shown:
    """A run that goes on in real time, at the pace of the viewer node."""

    def __init__(self, scene_name: str, recording: rr.RecordingStream) -> None:
        scene = load_scene(scene_name)
        simulator = Simulator(scene)
        self._recording, self._names = recording, simulator.joint_names
        self._q = simulator.state().q
        self._view = LiveView(recording, scene, _TASKS[:2])
        plots = blueprint(scene.camera, [ALPHA, ERRORS, TORQUE, TORQUE_RATE])
        patch = rrb.Spatial2DView(origin="patch", name="frame")
        recording.send_blueprint(
            rrb.Blueprint(
                rrb.Horizontal(patch, plots.root_container, column_shares=[1, 7]),
                rrb.BlueprintPanel(state="hidden"),
                rrb.SelectionPanel(state="hidden"),
                rrb.TimePanel(state="collapsed", timeline=TIMELINE),
            )
        )
        self._start, self._ends = time.monotonic(), threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    @property
    def frame(self) -> int:
        """Number of the frame that is due now."""
        return int((time.monotonic() - self._start) / FRAME_PERIOD)

    def end(self) -> None:
        """Stop sending."""
        self._ends.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._ends.wait(FRAME_PERIOD):
            self._draw(self.frame)

    def _draw(self, frame: int) -> None:
        now, count = frame * FRAME_PERIOD, len(self._names)
        q = self._q.copy()
        swing = 0.3 * np.sin(now + np.arange(count))
        base = q[: len(q) - count] if len(q) > count else None
        torque = 20.0 * np.cos(now + np.arange(count))
        self._view.show_state(now, self._names, q[-count:] + swing, torque, base)
        tasks = [
            SimpleNamespace(name=name, error=3 * [0.1], reference=3 * [0.4], error_norm=0.1)
            for name in _TASKS
        ]
        self._view.show_report(now, SimpleNamespace(tasks=tasks, alpha=[0.5] * len(_TASKS) ** 2))
        digit = frame % _DIGITS
        color = (_RED + frame // _DIGITS, digit, _DIGITS - 1 - digit)
        self._recording.set_time(TIMELINE, duration=now)
        self._recording.log("patch", rr.Image(np.full((16, 16, 3), color, dtype=np.uint8)))


def shown_frame(picture: Image.Image) -> int | None:
    """Number of the frame that a screenshot shows; None where there is no patch."""
    pixels = np.asarray(picture, dtype=np.int64).reshape(-1, 3)
    red, green, blue = pixels.T
    patch = (red >= _RED) & (red < 250) & (green + blue == _DIGITS - 1)
    if patch.sum() < 200:
        return None
    frames = (red[patch] - _RED) * _DIGITS + green[patch]
    values, counts = np.unique(frames, return_counts=True)
    return int(values[np.argmax(counts)])


def lags(scene: str, seconds: float, keep: Path | None) -> Iterator[tuple[float, float]]:
    """(time since the start [s], lag of the page [s]) every two seconds."""
    viewer, recording = start_viewer(window=False), new_recording()
    recording.connect_grpc(viewer.url)
    try:
        with (
            tempfile.TemporaryDirectory() as folder,
            Browser(viewer.page, Path(folder)) as browser,
        ):
            shown = Shown(scene, recording)
            try:
                while (now := shown.frame * FRAME_PERIOD) < seconds:
                    picture = Image.open(io.BytesIO(browser.screenshot())).convert("RGB")
                    found = shown_frame(picture)
                    if keep is not None:
                        picture.save(keep)
                    if found is not None:
                        yield now, now - found * FRAME_PERIOD
                    time.sleep(2.0)
            finally:
                shown.end()
    finally:
        recording.disconnect()
        viewer.end()


def main() -> None:
    """Print the lag over time."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="kuka_lwr")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--keep", type=Path, help="file for the last screenshot")
    options = parser.parse_args()
    found = []
    for now, lag in lags(options.scene, options.seconds, options.keep):
        found.append(lag)
        print(f"{now:6.1f} s: {lag:5.2f} s behind", flush=True)
    late = found[len(found) // 2 :]
    print(f"second half: median {np.median(late):.2f} s, largest {max(late):.2f} s behind")


if __name__ == "__main__":
    main()
