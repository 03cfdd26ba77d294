"""Writes docs/mpc_studies.md: results of the thesis next to ours."""

from __future__ import annotations

from pathlib import Path

from ghc_sim_bridge.programs.markdown import number, picture, table
from ghc_sim_bridge.programs.studies.force_study import ForceCase, linearity
from ghc_sim_bridge.programs.studies.motion_study import MotionCase
from ghc_sim_bridge.programs.studies.plan_of_studies import (
    HORIZONS,
    POWERS,
    WEIGHTS,
    Studies,
)

_HEAD = """# Studies of the constraint generators, without a robot

Written by `studies` (`ros2 run ghc_sim_bridge studies`) from its runs; nothing here is typed
in by hand. *The thesis* is M. Liu's, chapters 4 and 5. T = 0.01 s throughout. Names: alpha is
`upper_rate_weight` (beta, of the lower bound, `lower_rate_weight`), gamma is `jerk_weight`.
"""


def write_document(studies: Studies, docs: Path) -> Path:
    """Write the document into a folder; returns its path."""
    docs.mkdir(parents=True, exist_ok=True)
    sections = [
        _HEAD,
        _force(studies),
        _force_sweeps(studies),
        _motion(studies),
        _readings(studies),
        _ticks(studies),
    ]
    path = docs / "mpc_studies.md"
    text = "\n\n".join(section.strip() for section in sections if section)
    path.write_text(text + "\n", encoding="utf-8")
    return path


def _force(studies: Studies) -> str:
    first, second = (studies.force[ForceCase(weight=weight)] for weight in (0.1, 0.2))
    flat = [run.largest_rate for run in studies.by_horizon() if run.case.horizon >= 1.0]
    rows = [
        ["raw derivative, 5 N in one step [N/s]", "500", number(5.0 / 0.01, 3)],
        ["largest derivative, alpha 0.1, NT 1.5 s [N/s]", "15.5", number(first.largest_rate, 4)],
        ["largest derivative, alpha 0.2, NT 1.5 s [N/s]", "11", number(second.largest_rate, 4)],
        [
            "the same for NT 1.0 to 3.0 s, alpha 0.2: smallest, largest [N/s]",
            "11, 'a little bit' less",
            f"{number(min(flat), 4)}, {number(max(flat), 4)}",
        ],
        ["begins to move, alpha 0.2, NT 1.5 s [s]", "2.5", f"{second.starts_at:.2f}"],
        [
            "derivative against size of the jump, R²",
            "linear",
            f"{linearity(studies.by_jump()):.9f}",
        ],
    ]
    return (
        "## Contact force bounds (section 5.2)\n\n"
        f"{table(['', 'thesis', 'here'], rows)}\n\n"
        "The largest derivative of an endless preview is jump / sqrt(alpha) in continuous time "
        "(15.8 and 11.2 N/s); the step takes T / (2 sqrt(alpha)) of it. 'Begins to move' is by a "
        "hundredth of the jump.\n\n"
        "On the right of figure 5.4 the contact is to carry at least 1 N until it breaks at 4 s: "
        "no bound can be continuous there. A schedule that lowers Fmin before a break "
        "leaves none of that step.\n\n"
        + picture("mpc_force_evolution.png", "Figures 5.3 and 5.4: one bound, and both.")
    )


def _force_sweeps(studies: Studies) -> str:
    weights = [
        [
            f"{run.case.weight:g}",
            number(run.largest_rate, 3),
            number(run.error, 3),
            f"{run.starts_at:.2f}",
        ]
        for run in studies.by_weight()
    ]
    grid = [
        [f"{weight:g}", *(number(run.largest_rate, 3) for run in row)]
        for weight, row in zip(WEIGHTS, studies.grid(5.0), strict=True)
    ]
    ratio = [
        abs(large.largest_rate / small.largest_rate / 10.0 - 1.0)
        for rows in zip(studies.grid(5.0), studies.grid(50.0), strict=True)
        for small, large in zip(*rows, strict=True)
    ]
    return (
        "### Weight and horizon (figures 5.5 to 5.10)\n\n"
        + table(["alpha [s²]", "largest derivative [N/s]", "E [N]", "begins at [s]"], weights)
        + "\n\n"
        + picture("mpc_force_weight.png", "Figures 5.5 and 5.6: by weight, NT = 1.5 s.")
        + "\n\n"
        + picture("mpc_force_horizon.png", "Figure 5.7: by horizon, alpha = 0.2.")
        + "\n\nLargest derivative [N/s] for a jump of 5 N, by alpha (rows) and NT (columns):\n\n"
        + table(["alpha [s²]", *(f"{h:g} s" for h in HORIZONS)], grid)
        + f"\n\nFor 50 N every entry is ten times as large, to {number(max(ratio))} of itself.\n\n"
        + picture("mpc_force_grid.png", "Figures 5.8 to 5.10: both, for 5 N and 50 N; by jump.")
    )


def _motion(studies: Studies) -> str:
    gammas = [
        [f"{run.case.jerk_weight:.0e}", f"{run.overshoot:.2f}"] for run in studies.by_gamma()
    ]
    horizons = [
        [f"{run.case.horizon:g}", f"{run.overshoot:.2f}"] for run in studies.by_motion_horizon()
    ]
    powers = [
        [f"{power:g}", f"{run.overshoot:.2f}"]
        for power, run in zip(POWERS, studies.by_power(), strict=True)
    ]
    with_d = studies.motion[MotionCase(dynamic=True)]
    return (
        "## Obstacle motion (section 4.4)\n\n"
        "d_s = 0.4 m, d_v = 0.2 m, v_max = 0.1 m/s, so t_r = 2 s (eq. 4.4); gamma = 1e-5, "
        "NT = 1.5 s. Overshoot in per cent of the steady state, 0.2 m.\n\n"
        + picture("mpc_obstacle_evolution.png", "Figures 4.5 and 4.8.")
        + "\n\n"
        + table(["gamma [s⁶]", "overshoot, constant weight [%]"], gammas)
        + "\n\n"
        + table(["NT [s]", "overshoot, constant weight [%]"], horizons)
        + "\n\n"
        + picture("mpc_obstacle_overshoot.png", "Figures 4.6 and 4.7.")
        + f"\n\nWith the dynamic weighting matrix D (g = 7): {with_d.overshoot:.2f} %. By its "
        "power:\n\n" + table(["g", "overshoot with D [%]"], powers)
    )


def _readings(studies: Studies) -> str:
    rows = [[reading.title, f"{value:.1f}"] for reading, value in studies.readings.items()]
    return (
        "### Where the thesis' 31 % may come from\n\n"
        "The pattern of figures 4.6(b) and 4.7(b) is here: the same overshoot up to gamma = 1e-5 "
        "and more from 1e-4 on, falling with NT up to about 1.1 s and flat beyond. The level is "
        "not: the thesis has 31 %. Other readings of eq. 4.14, at T = 0.02 s:\n\n"
        + table(["reading", "overshoot [%]"], rows)
        + "\n\nFor a given cost and constraint the overshoot is a fixed share of the jump, "
        "whatever its size, since the problem scales. So no reading with d_s = 0.4 m and "
        "d_v = 0.2 m that we tried gives 31 %. The percentage is one of the steady state "
        "(Nise), though: an obstacle that comes from 0.5 m instead of from the edge of the safe "
        "distance makes a jump 1.5 times its steady state, and that gives the thesis' figure. "
        "The text does not say where figure 4.5 begins; assumption 1 of section 4.4.1 would put "
        "it at the edge."
    )


def _ticks(studies: Studies) -> str:
    if not studies.ticks:
        return ""
    rows = [
        [
            f"`{case.generator}`",
            str(case.count),
            f"{case.horizon:g}",
            number(1e3 * run.start),
            number(1e3 * run.first),
            number(1e3 * run.median),
            number(1e3 * run.p99),
            number(1e3 * run.own),
        ]
        for case, run in studies.ticks.items()
    ]
    head = [
        "generator",
        "contacts / obstacles",
        "NT [s]",
        "start [ms]",
        "first tick [ms]",
        "median [ms]",
        "p99 [ms]",
        "median, own time [ms]",
    ]
    return (
        "## Time per tick\n\n"
        "Every tick has changes in its horizon: both bounds of every contact jump each half "
        "second, every obstacle moves along all axes at 10 Hz. Wall times of one process on a "
        "machine that may do other work as well, and the thread's own time, which leaves that "
        "out.\n\n" + table(head, rows)
    )
