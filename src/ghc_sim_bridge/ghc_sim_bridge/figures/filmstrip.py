"""Filmstrip of a run: frames side by side, each with its time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ghc_controller.errors import InvalidValue
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.scene.values import SceneDescription
from ghc_sim_bridge.simulation.rendering import Picture, Renderer, filmstrip, save_png

FRAMES = 6  # default number of frames
FRAME_SIZE = (300, 360)  # [pixel]
_TEXT_HEIGHT = 18  # [pixel]
_MARGIN = 8  # [pixel]


def log_filmstrip(
    log: FullRateLog,
    scene: SceneDescription,
    times: Sequence[float] = (),
    size: tuple[int, int] = FRAME_SIZE,
    columns: int | None = None,
) -> Picture:
    """Frames of a log at given times [s], `columns` per row; evenly spaced by default.

    Raises:
        InvalidValue: the log is empty.
        RenderingUnavailable: off-screen OpenGL is not available.
    """
    if len(log.time) == 0:
        raise InvalidValue("the log is empty: there is nothing to draw")
    chosen = times if len(times) else np.linspace(log.time[0], log.time[-1], FRAMES)
    with Renderer(scene, size, log.joint_names) as renderer:
        pictures = []
        for time in chosen:
            row = min(int(np.searchsorted(log.time, time - 1e-9)), len(log.time) - 1)
            picture = renderer.draw(log.configuration(row))
            pictures.append(_captioned(picture, f"{log.time[row]:.2f} s"))
    return filmstrip(pictures, columns)


def write_filmstrip(
    file: Path, log: FullRateLog, scene: SceneDescription, times: Sequence[float] = ()
) -> None:
    """Write `log_filmstrip` as a PNG."""
    save_png(log_filmstrip(log, scene, times), file)


def _captioned(picture: Picture, text: str) -> Picture:
    image = Image.fromarray(picture)
    font = ImageFont.load_default(_TEXT_HEIGHT)
    ImageDraw.Draw(image).text((_MARGIN, _MARGIN), text, fill="#303030", font=font)
    return np.asarray(image)
