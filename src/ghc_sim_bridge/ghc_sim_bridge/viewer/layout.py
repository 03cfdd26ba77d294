"""Layout of a run in the Rerun viewer, complete without any clicks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from ghc_sim_bridge.colors import rgb
from ghc_sim_bridge.scene.description import Camera, SceneDescription

APPLICATION = "ghc_control"
TIMELINE = "simulated time"
ALPHA = "plots/alpha"
ERRORS = "plots/task_error"
TORQUE = "plots/torque"
TORQUE_RATE = "plots/torque_rate"
FORCE = "plots/contact_force"
_TITLES = {
    ALPHA: "Priorities alpha [-]: 'a > b' is 1 where a is strictly above b",
    ERRORS: "Task errors [m], [rad]",
    TORQUE: "Joint torques [Nm]",
    TORQUE_RATE: "Joint torque rates [Nm/s]",
    FORCE: "Contact forces on the robot [N]",
}
# The viewer's light is bright: a light floor would outshine the robot on it.
SHADE = np.array([0.4, 0.4, 0.4, 1.0])
ENDLESS = 3.0  # [m] drawn of a plane without an end
SHEET = 0.002  # [m] height drawn of a plane


def new_recording() -> rr.RecordingStream:
    """An empty recording with simulated time as its only timeline."""
    recording = rr.RecordingStream(APPLICATION, send_properties=False)
    recording.set_log_time_enabled(False)
    recording.set_log_tick_enabled(False)
    return recording


def colours(count: int) -> NDArray[np.uint8]:
    """One color per line, (count, 3); colors repeat after the last one."""
    return np.array([rgb(index) for index in range(count)], dtype=np.uint8).reshape(-1, 3)


def blueprint(camera: Camera, plots: Sequence[str]) -> rrb.Blueprint:
    """The robot on the left, `plots` on one timeline on the right."""
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Spatial3DView(
                origin="world",
                name="Robot, targets and their errors",
                eye_controls=rrb.EyeControls3D(
                    position=_eye(camera), look_target=camera.look_at, eye_up=(0.0, 0.0, 1.0)
                ),
            ),
            rrb.Vertical(
                *(
                    rrb.TimeSeriesView(
                        origin=plot, name=_TITLES[plot], plot_legend=rrb.Corner2D.RightTop
                    )
                    for plot in plots
                )
            ),
            column_shares=[3, 4],
        ),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE),
    )


def _eye(camera: Camera) -> NDArray[np.float64]:
    azimuth, elevation = np.radians(camera.azimuth), np.radians(camera.elevation)
    sight = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    return np.asarray(camera.look_at) - camera.distance * sight


def log_surroundings(recording: rr.RecordingStream, scene: SceneDescription) -> None:
    """Log the environment of the robot, and that z points up."""
    recording.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for surface in scene.surfaces:
        flat = (surface.size[0] or ENDLESS, surface.size[1] or ENDLESS)
        height = surface.size[2] if surface.kind == "box" else SHEET
        half = np.array([*flat, height]) / 2.0
        recording.log(
            f"world/surroundings/{surface.name}",
            rr.Boxes3D(
                half_sizes=[half],
                centers=[np.asarray(surface.top) - [0.0, 0.0, half[2]]],
                colors=[np.round(255 * SHADE * np.asarray(surface.colour)).astype(np.uint8)],
                fill_mode=rr.components.FillMode.Solid,
            ),
            static=True,
        )


def log_lines(recording: rr.RecordingStream, plot: str, names: Sequence[str]) -> None:
    """Name and color the lines of a plot."""
    recording.log(plot, rr.SeriesLines(names=list(names), colors=colours(len(names))), static=True)


def alpha_lines(tasks: Sequence[str]) -> list[tuple[str, int, int]]:
    """(name, i, j) of the entries alpha[i, j]: j above i, and on the diagonal i switched off."""
    pairs = [
        (f"{above} > {below}", i, j)
        for j, above in enumerate(tasks)
        for i, below in enumerate(tasks)
        if i != j
    ]
    return pairs + [(f"{task} off", i, i) for i, task in enumerate(tasks)]
