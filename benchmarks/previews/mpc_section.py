"""The section of docs/benchmarks.md on the generators' ticks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benchmarks.previews.mpc_loads import CHANGE_EVERY, STEP
from benchmarks.previews.mpc_report import generators_of, mpc_table, start_table
from ghc_sim_bridge.programs.markdown import picture

TICK_FIGURE = "tick_time.png"

_TEXT = """## Time per tick of the generators

Each plan of `contact_force_bounds` and `obstacle_bounds` at T = {step:g} s, in this process,
without messages. Both bounds of every contact jump every 0.4 s; every obstacle jumps about within
its safe distance, along all axes. So every tick has a change in its horizon ({moving:.0f} % of the
ticks were smoothed and moved in all that they plan). Every {every} ticks something new comes:
other schedules for all contacts, other places for all obstacles.

- **change seen before**: the ticks between two such inputs.
- **new inputs**: the first tick that knows them.
- **first tick**: of a generator just made: nothing is planned.

Median (p99) in microseconds, by kind of tick and horizon N T.
"""


def tick_section(mpc: Sequence[dict[str, Any]]) -> list[str]:
    """Blocks of Markdown; the figure is expected in figures/."""
    moving = 100.0 * min(row["moving_share"] for row in mpc)
    parts = [
        _TEXT.format(step=STEP, every=CHANGE_EVERY, moving=moving),
        picture(
            TICK_FIGURE,
            "Median time per tick with a change seen before, whiskers up to the 99th percentile; "
            "dotted: with new inputs; grey: the goal for 4 at 1.5 s",
        )
        + "\n",
    ]
    for generator in generators_of(mpc):
        parts.append(f"### {generator}\n")
        parts.append(mpc_table(mpc, generator) + "\n")
    parts.append("Making a generator, mostly the matrices of its horizon, in milliseconds:\n")
    parts.append(start_table(mpc) + "\n")
    return parts
