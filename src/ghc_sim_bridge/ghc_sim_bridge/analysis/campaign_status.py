"""Whether a robot that was disturbed still stands, and how many do; no ROS, no files."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ghc_sim_bridge.analysis.metrics import torque_jumps
from ghc_sim_bridge.analysis.standing import NOT_FALLEN, base_tilt
from ghc_sim_bridge.analysis.text_table import aligned
from ghc_sim_bridge.logs.full_rate_log import FullRateLog


@dataclass(frozen=True, slots=True)
class RunStatus:
    """What became of one run."""

    scenario: str
    generators: bool
    seed: int
    stays_up: bool = False
    height: float = math.nan  # [m] of the base at the end
    tilt: float = math.nan  # [rad] of the base's z axis against the vertical at the end
    peak_torque_rate: float = math.nan  # [Nm/s] of any joint, at the control period
    fallback_ticks: int = 0  # control steps without an answer, in which the joints braked
    problem: str = ""  # what else went wrong: a node that did not end in order, no log to judge


@dataclass(frozen=True, slots=True)
class Total:
    """A scenario on one side, over all seeds."""

    scenario: str
    generators: bool
    runs: int
    stay_up: int
    fallen_seeds: tuple[int, ...]
    fallback_ticks: int = 0


def judge(status: RunStatus, log: FullRateLog, nominal_height: float) -> RunStatus:
    """Fill in a status; a robot that is up at the end has not fallen before: it cannot rise."""
    if log.base_pose is None or len(log.time) == 0:
        return replace(status, problem="no base in the log")
    height = float(log.base_pose[-1, 2])
    tilt = float(base_tilt(log.base_pose[-1:])[0])
    return replace(
        status,
        stays_up=NOT_FALLEN.holds(height, tilt, nominal_height),
        height=height,
        tilt=math.radians(tilt),
        peak_torque_rate=float(torque_jumps(log.torque).max() / log.control_dt),
    )


def tally(runs_done: Sequence[RunStatus]) -> tuple[Total, ...]:
    """Totals in the order in which scenarios came, without generators first."""
    order = list(dict.fromkeys(status.scenario for status in runs_done))
    totals = []
    for scenario in order:
        for generators in (False, True):
            runs = [v for v in runs_done if (v.scenario, v.generators) == (scenario, generators)]
            fallen = tuple(status.seed for status in runs if not status.stays_up)
            braked = sum(status.fallback_ticks for status in runs)
            up = len(runs) - len(fallen)
            totals.append(Total(scenario, generators, len(runs), up, fallen, braked))
    return tuple(totals)


def campaign_table(totals: Sequence[Total]) -> str:
    """The totals as text."""
    rows = [
        [
            total.scenario,
            "on" if total.generators else "off",
            f"{total.stay_up} of {total.runs}",
            ", ".join(map(str, total.fallen_seeds)) or "none",
            str(total.fallback_ticks),
        ]
        for total in totals
    ]
    head = ["scenario", "generators", "stay up", "seeds that fall", "fallback ticks"]
    return aligned(head, rows, left=(0, 1, 3))
