"""The cases of each figure of the thesis, and their results by figure."""

from __future__ import annotations

import os
from dataclasses import dataclass

from ghc_sim_bridge.programs.studies.force_study import ForceCase, ForceRun, run_force
from ghc_sim_bridge.programs.studies.motion_study import MotionCase, MotionRun, run_motion
from ghc_sim_bridge.programs.studies.readings import READINGS, Reading
from ghc_sim_bridge.programs.studies.sweep import run_all
from ghc_sim_bridge.programs.studies.tick_times import TickCase, TickTimes, time_ticks

WEIGHTS = (1e-3, 1e-2, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0)  # [s^2] alpha
HORIZONS = (0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.5, 2.0, 3.0)  # [s]
JUMPS = (5.0, 10.0, 20.0, 30.0, 40.0, 50.0)  # [N]
GAMMAS = (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)  # [s^6]
MOTION_HORIZONS = (0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.3, 1.5, 2.0)  # [s]
POWERS = (3.0, 5.0, 6.0, 7.0, 8.0, 10.0)  # [-] g
TICK_COUNTS = (1, 2, 4, 8)
TICK_HORIZONS = (0.5, 1.0, 1.5, 3.0)  # [s]


@dataclass(frozen=True, slots=True)
class Studies:
    """All results, by case."""

    force: dict[ForceCase, ForceRun]
    motion: dict[MotionCase, MotionRun]
    readings: dict[Reading, float]
    ticks: dict[TickCase, TickTimes]

    def by_weight(self) -> list[ForceRun]:
        """Figures 5.5 and 5.6: N T = 1.5 s, 5 N."""
        return [self.force[ForceCase(weight=weight)] for weight in WEIGHTS]

    def by_horizon(self) -> list[ForceRun]:
        """Figure 5.7: alpha = 0.2, 5 N."""
        return [self.force[ForceCase(weight=0.2, horizon=horizon)] for horizon in HORIZONS]

    def grid(self, jump: float) -> list[list[ForceRun]]:
        """Figures 5.8 (5 N) and 5.9 (50 N): rows by weight, columns by horizon."""
        return [[self.force[ForceCase(jump, w, h)] for h in HORIZONS] for w in WEIGHTS]

    def by_jump(self) -> list[ForceRun]:
        """Figure 5.10: alpha = 0.4, N T = 1.0 s."""
        return [self.force[ForceCase(jump, 0.4, 1.0)] for jump in JUMPS]

    def by_gamma(self) -> list[MotionRun]:
        """Figure 4.6."""
        return [self.motion[MotionCase(jerk_weight=gamma)] for gamma in GAMMAS]

    def by_motion_horizon(self) -> list[MotionRun]:
        """Figure 4.7."""
        return [self.motion[MotionCase(horizon=horizon)] for horizon in MOTION_HORIZONS]

    def by_power(self) -> list[MotionRun]:
        """Results with D, by its power g."""
        return [self.motion[MotionCase(dynamic=True, power=power)] for power in POWERS]


def run_studies(workers: int, with_ticks: bool = True) -> Studies:
    """Run all cases in `workers` processes; the timing runs alone."""
    force = {ForceCase(jump, w, h) for jump in (5.0, 50.0) for w in WEIGHTS for h in HORIZONS}
    force |= {ForceCase(jump, 0.4, 1.0) for jump in JUMPS}
    motion = {MotionCase(jerk_weight=gamma) for gamma in GAMMAS}
    motion |= {MotionCase(horizon=horizon) for horizon in MOTION_HORIZONS}
    motion |= {MotionCase(dynamic=True, power=power) for power in POWERS}
    ticks = [
        TickCase(generator, count, horizon)
        for generator in ("contact_force_bounds", "obstacle_bounds")
        for horizon in TICK_HORIZONS
        for count in (TICK_COUNTS if horizon == 1.5 else (4,))
    ]
    force_cases = sorted(force, key=str)
    motion_cases = sorted(motion, key=str)
    runs = run_all("force bounds", run_force, force_cases, workers)
    courses = run_all("obstacle", run_motion, motion_cases, workers)
    overshoots = run_all("readings", Reading.overshoot, READINGS, workers)
    times = run_all("tick times", time_ticks, ticks, 1) if with_ticks else []
    return Studies(
        {run.case: run for run in runs},
        {run.case: run for run in courses},
        dict(zip(READINGS, overshoots, strict=True)),
        {run.case: run for run in times},
    )


def all_workers() -> int:
    """Number of CPU cores."""
    return os.cpu_count() or 1
