"""The colors of figures, animations and viewers: one home, so that a task has one everywhere.

The first seven are distinct for every kind of color vision (Okabe and Ito, without black, which a
dark viewer hides); the others are told from them by their lightness. The first four keep clear of
orange, the color of the arm that most pictures show.
"""

from __future__ import annotations

Rgba = tuple[float, float, float, float]

PALETTE = (
    "#0072B2",  # blue
    "#009E73",  # green
    "#CC79A7",  # pink
    "#56B4E9",  # sky
    "#D55E00",  # vermilion
    "#E69F00",  # orange
    "#7F7F7F",  # gray
    "#882255",  # wine
    "#B3A829",  # olive
    "#8C564B",  # brown
    "#6A4FCF",  # violet
    "#1FA8A8",  # teal
)
# What is drawn beside tasks and joints.
SHOWN = PALETTE[0]  # what a figure is about
MEASURED = PALETTE[3]
BOUND = PALETTE[4]
_DASHES = ("-", "--", ":", "-.")


def color(index: int) -> str:
    """Color of the task or joint at an index, as #RRGGBB; more than there are begin anew."""
    return PALETTE[index % len(PALETTE)]


def dashes(index: int) -> str:
    """Line style that distinguishes curves of one color."""
    return _DASHES[index // len(PALETTE) % len(_DASHES)]


def rgb(index: int) -> tuple[int, int, int]:
    """The same color as three bytes."""
    text = color(index)
    return int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)


def rgba(text: str, opacity: float = 1.0) -> Rgba:
    """#RRGGBB as numbers from 0 to 1, with an opacity."""
    red, green, blue = (int(text[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
    return red, green, blue, opacity
