"""Table, plot and page of the comparison with tsid and placo."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.peers.problem import WEIGHT_STEP
from ghc_controller.report.valid_json import json_text
from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled
from ghc_sim_bridge.programs.markdown import table

OURS = ("cascade", "balanced", "ghc")
PEERS = ("tsid", "placo")
Row = Mapping[str, Any]


def ratio(row: Row) -> float:
    """Median of `cascade` over that of the faster peer."""
    return float(row["cascade"]["p50_us"] / min(row[peer]["p50_us"] for peer in PEERS))


def peers_table(rows: Sequence[Row]) -> str:
    """Median (p99) [us] of every side, the ratio, and QPs per step of `cascade`."""
    lines = []
    for row in rows:
        times = [f"{row[s]['p50_us']:.1f} ({row[s]['p99_us']:.0f})" for s in (*OURS, *PEERS)]
        counts = f"{row['cascade']['qps']:.1f}, {row['cascade']['pivots']:.1f}"
        lines.append([row["case"], *times, f"{ratio(row):.2f}", counts])
    return table(["case", *OURS, *PEERS, "cascade / faster peer", "QPs, pivots"], lines)


def plot_peers(rows: Sequence[Row], path: Path) -> None:
    """Medians of all sides, a group of bars a case."""
    with styled():
        figure = new_figure(10.0, 4.0)
        ax = figure.subplots()
        sides = (*OURS, *PEERS)
        width = 0.8 / len(sides)
        for index, side in enumerate(sides):
            places = np.arange(len(rows)) + (index - 0.5 * (len(sides) - 1)) * width
            ax.bar(places, [row[side]["p50_us"] for row in rows], width, color=colour(index))
        ax.set_yscale("log")
        ax.set_xticks(range(len(rows)), [row["case"] for row in rows], rotation=35, ha="right")
        ax.grid(visible=False, axis="x")
        ax.set_ylabel("median of a control step [us]")
        figure.legend(sides, loc="outside right upper")
        save_png(figure, path)


_PAGE = """# Beside tsid and placo

Written by `make bench ARGS="--only peers --write-docs"`, which installs tsid {tsid} and placo
{placo} from locks of their own. One control step called from Python, model update included, at the
same recorded states (`benchmarks/peers/states/`), all sides in turn in one run: median (p99) in
microseconds. Machine: {cpu}, {cores} cores, load {load}; the ratios matter, not the times.
All percentiles, also of CPU time: [peers.json](bench/peers.json).

{table}

![Median of a control step](figures/peers.png)

What differs:

- `cascade` has exact levels in strict order; `balanced` and `ghc` have this project's projectors.
  tsid and placo have soft weights, a factor of {factor:g} from level to level: they solve one QP
  where a cascade solves one for each level that meets a bound.
- Limits on torque, velocity and position hold on all sides. `bounds`: torque limits that the tasks
  reach. tsid and placo take symmetric torque limits, so the limits of these cases are symmetric.
- Standing: eight contact points with friction pyramids here, a wrench for each sole there.
- `ramp`: two orders in force; the others, which know no transition, keep one.
- Here a step includes interpolated references, the check of the answer by residuals, the gate and
  the report. The others return a status.
- p99: goals change every 25 states. The others take the new goals alone, this project's controller
  is reset and started. The step after that, 4 in 100, has what the others have not: the torque
  that holds the robot, and all that is asked anew after a reset. That step is the p99 of
  `cascade`. Of all others, at the fastest of 45 runs, the slowest takes 1.1 to 1.5 times the
  median; with a ramp, whose second step is the other one that asks anew, 2 to 3 times.
- tsid's wheel of 1.10.0 ended at its first call with the Pinocchio that it asks for, so 1.7.1 is
  measured. Its hierarchies of more than two levels are in no wheel.
"""


def write_page(results: Mapping[str, Any], docs: Path) -> None:
    """Write docs/peers.md, its figure, and the figures of every side as JSON."""
    machine = results["machine"]
    text = _PAGE.format(
        **results["peers"],
        cpu=machine["cpu"],
        cores=machine["cores"],
        load=results["load_average"]["before"],
        table=peers_table(results["rows"]),
        factor=WEIGHT_STEP,
    )
    (docs / "peers.md").write_text(text, encoding="utf-8")
    numbers = docs / "bench" / "peers.json"
    numbers.parent.mkdir(exist_ok=True)
    numbers.write_text(json_text(results, 1) + "\n", encoding="utf-8")
    plot_peers(results["rows"], docs / "figures" / "peers.png")
