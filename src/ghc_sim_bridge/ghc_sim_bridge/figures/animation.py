"""Animation of a run: the robot with its targets, next to task errors and joint torques."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from ghc_sim_bridge.analysis.analysis import Analysis
from ghc_sim_bridge.analysis.task_errors import TaskHistory
from ghc_sim_bridge.colors import color, dashes, rgba
from ghc_sim_bridge.figures.style import mark_phases, new_figure, styled
from ghc_sim_bridge.scene.values import Camera, SceneDescription
from ghc_sim_bridge.simulation.rendering import Marker, Picture, Renderer

ARM_SIZE = (380, 360)  # [pixel]
PLOT_SIZE = (400, 360)  # [pixel]
CAPTION_HEIGHT = 40  # [pixel]
CLOSER = 0.8  # of the camera's distance, since the frame is narrow
TEXT_HEIGHT = 16  # [pixel]
PALETTE = 96  # colors of the file
_DPI = 100
_LEAST_ERROR = 1e-6  # [m] or [rad] lower end of the axis
_GREY = "#404040"


def frames(
    analysis: Analysis, scene: SceneDescription, step: float, *, plots: bool = True
) -> Iterator[Picture]:
    """One frame every `step` [s] of simulated time; raises RenderingUnavailable.

    Args:
        plots: errors and torques next to the robot; False = the robot only.
    """
    beside = _Plots(analysis) if plots else None
    camera = _closer(scene.camera) if plots else scene.camera
    log, end = analysis.log, analysis.plan.duration
    with Renderer(scene, ARM_SIZE, log.joint_names) as renderer:
        for time in np.arange(0.0, end, step):
            row = min(int(np.searchsorted(log.time, time)), len(log.time) - 1)
            picture = renderer.draw(log.configuration(row), _targets(analysis, time), camera)
            if beside is None:
                yield picture
            else:
                both = np.hstack([picture, beside.at(time / end)])
                yield np.vstack([_caption(analysis, time), both])


def save_gif(pictures: Sequence[Picture], file: Path, period: float) -> None:
    """Write a looping GIF, `period` [s] per frame, with one palette for all frames."""
    sample = np.vstack(pictures[:: max(1, len(pictures) // 8)])
    palette = Image.fromarray(sample).quantize(PALETTE, dither=Image.Dither.NONE)
    images = [
        Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE)
        for picture in pictures
    ]
    file.parent.mkdir(parents=True, exist_ok=True)
    images[0].save(
        file, save_all=True, append_images=images[1:], duration=round(1e3 * period), loop=0
    )


def _closer(camera: Camera) -> Camera:
    return Camera(
        camera.look_at,
        CLOSER * camera.distance,
        camera.azimuth,
        camera.elevation,
        camera.field_of_view,
    )


def _targets(analysis: Analysis, time: float) -> list[Marker]:
    """A ball in the task's color at each Cartesian position reference."""
    history = analysis.history
    row = min(int(np.searchsorted(history.time, time)), len(history.time) - 1)
    markers = []
    for index, task in enumerate(history.tasks):
        if task.unit == "m" and task.reference.shape[1] == 3:
            x, y, z = task.reference[row]
            markers.append(Marker((x, y, z), 0.03, rgba(color(index))))
    return markers


def _caption(analysis: Analysis, time: float) -> Picture:
    """Time and the current hierarchy, each task in its color."""
    image = Image.new("RGB", (ARM_SIZE[0] + PLOT_SIZE[0], CAPTION_HEIGHT), "white")
    draw = ImageDraw.Draw(image)
    font = ImageFont.load_default(TEXT_HEIGHT)
    planned = next(p for p in reversed(analysis.plan.phases) if time >= p.start)
    tasks = [task.name for task in analysis.history.tasks]
    x, y = 10.0, (CAPTION_HEIGHT - TEXT_HEIGHT) // 2
    draw.text((x, y), f"t = {time:.1f} s", fill=_GREY, font=font)
    x += draw.textlength("t = 00.0 s    ", font=font)
    for word in planned.phase.hierarchy.split():
        ink = color(tasks.index(word)) if word in tasks else _GREY
        draw.text((x, y), word, fill=ink, font=font)
        x += draw.textlength(word + "  ", font=font)
    if time < planned.start + planned.ramp:
        draw.text((x, y), "  (priorities change)", fill=_GREY, font=font)
    return np.asarray(image)


class _Plots:
    """Errors above torques, with a line at the current time."""

    def __init__(self, analysis: Analysis) -> None:
        self._picture, self._left, self._right = _plots(analysis)

    def at(self, share: float) -> Picture:
        """The plots with the line at a fraction of the run's duration."""
        picture = self._picture.copy()
        picture[:, round(self._left + (self._right - self._left) * share)] = (90, 90, 90)
        return picture


def _plots(analysis: Analysis) -> tuple[Picture, int, int]:
    """Errors above torques, and the positions of time zero and the end [pixel]."""
    with styled():
        figure = new_figure(PLOT_SIZE[0] / _DPI, PLOT_SIZE[1] / _DPI)
        errors, torques = figure.subplots(2, 1, sharex=True)
        for index, task in enumerate(analysis.history.tasks):
            _draw_error(errors, analysis, index, task)
        errors.set_yscale("log")
        errors.set_ylim(_LEAST_ERROR, 10.0)
        errors.legend(  # above the axes, to cover no curve
            loc="lower center",
            bbox_to_anchor=(0.5, 0.97),
            ncols=3,
            fontsize=7,
            columnspacing=0.8,
            handlelength=1.0,
        )
        step = max(1, round(0.01 / analysis.log.control_dt))
        log = analysis.log
        for joint, torque in enumerate(log.torque[::step].T):
            style = {"color": color(joint), "linestyle": dashes(joint)}
            torques.plot(log.time[::step], torque, lw=1.0, **style)
        torques.set_ylabel("joint torques [Nm]")
        torques.set_xlabel("simulated time [s]")
        for axes in (errors, torques):
            mark_phases(axes, analysis.plan.phases)
    return _rasterized(figure, errors)


def _draw_error(axes: Axes, analysis: Analysis, index: int, task: TaskHistory) -> None:
    error = np.maximum(task.error, _LEAST_ERROR)
    axes.plot(analysis.history.time, error, color=color(index), label=task.name)
    axes.set_ylabel("task errors [m], [rad]")


def _rasterized(figure: Figure, axes: Axes) -> tuple[Picture, int, int]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.set_dpi(_DPI)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels: NDArray[np.uint8] = np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
    box = axes.get_window_extent()
    return pixels, round(box.x0), round(box.x1)
