"""A task or joint has one color in figures, animations, and the viewer."""

from __future__ import annotations

from matplotlib.colors import to_rgb

from ghc_sim_bridge.colors import color, rgba
from ghc_sim_bridge.figures.style import COLOURS
from ghc_sim_bridge.viewer.layout import colours

COUNT = 2 * len(COLOURS) + 1


def test_figures_animations_and_viewer_agree() -> None:
    shown = colours(COUNT)
    for index in range(COUNT):
        figure = to_rgb(COLOURS[index % len(COLOURS)])
        assert tuple(round(255 * part) for part in figure) == tuple(int(x) for x in shown[index])
        assert rgba(color(index))[:3] == figure
