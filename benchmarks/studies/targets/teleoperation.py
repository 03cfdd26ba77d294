"""An operator's stream of poses over a bad channel, followed by the KUKA: several seeds."""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.study_results import shown
from benchmarks.targets.reachable_loop import Case, run_loop
from benchmarks.targets.target_streams import Channel, position_at, teleoperation_curve
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "teleoperation"
TITLE = "Teleoperation: one stream of poses with jitter and loss"
FORMULATIONS = ("cascade",)
LARGEST_ERROR = {20.0: 8e-3, 50.0: 5e-3, 100.0: 5e-3}  # [m] mean, by rate [Hz]
LARGEST_STEP = 0.01  # [Nm] per ms
_CASE = Case("kuka_lwr", "kuka_lwr", "end_effector")
_SEEDS = (1, 2)
_END = 5.0  # [s]
_MOVING = 2.0  # [s] from which on the operator moves at speed


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Mean error at the same time and largest torque step, by rate, stamps and seed."""
    robot = ghc.load_robot(_CASE.robot)
    q = Simulator(_CASE.scene, joint_names=robot.model.joint_names).state().q
    curve = teleoperation_curve(position_at(robot, robot.tasks[0], q))
    times = np.arange(_MOVING, _END, 1e-3)
    speed = np.linalg.norm(np.diff([curve(time) for time in times], axis=0), axis=1) / 1e-3
    end, seeds = (2.5, _SEEDS[:1]) if quick else (_END, _SEEDS)
    rates = (50.0,) if quick else tuple(LARGEST_ERROR)
    found = {
        name: {
            "runs": [
                _measured(name, curve, rate, stamped, seed, end)
                for seed in seeds
                for stamped in (True, False)
                for rate in rates
            ]
        }
        for name in formulations
    }
    return {
        "facts": {"seeds": len(seeds), "mean_speed": float(speed.mean()), "quick": quick},
        "formulations": found,
    }


def _measured(
    name: str, curve: Any, rate: float, stamped: bool, seed: int, end: float
) -> dict[str, Any]:
    moving = run_loop(_CASE, curve, end, Channel(rate), seed, name, stamped).after(_MOVING)
    return {
        "rate": rate,
        "stamps": "sender" if stamped else "arrival",
        "seed": seed,
        "mean": float(moving.error.mean()),
        "largest": float(moving.error.max()),
        "step": float(moving.step.max()),
    }


def table(result: dict[str, Any]) -> str:
    """The worst of the seeds per rate."""
    parts = [_TEXT.format(**result["facts"])]
    for name, found in result["formulations"].items():
        parts.append(f"Formulation `{name}`:")
        groups: dict[tuple[float, str], list[dict[str, Any]]] = {}
        for row in found["runs"]:
            groups.setdefault((row["rate"], row["stamps"]), []).append(row)
        parts.append(
            markdown_table(
                [
                    "rate [Hz]",
                    "stamps of",
                    "mean error [mm], worst seed",
                    "asked",
                    "largest error [mm]",
                    "largest torque step [Nm per ms]",
                    "asked",
                ],
                [
                    [f"{rate:g}", stamps]
                    + [shown(1e3 * max(r["mean"] for r in group), ".2f")]
                    + [f"{1e3 * LARGEST_ERROR[rate]:g}"]
                    + [shown(1e3 * max(r["largest"] for r in group), ".2f")]
                    + [shown(max(r["step"] for r in group), ".4f"), f"{LARGEST_STEP:g}"]
                    for (rate, stamps), group in groups.items()
                ],
            )
        )
    return "\n\n".join(parts)


_TEXT = (
    "An operator's figure of eight at {mean_speed:.2f} m/s on the KUKA, one pose per sample, no "
    "velocities; 5 ms of jitter, 2 % lost, {seeds} seeds. The error is that to the operator's "
    "continuous curve at the same time, delays included, once it moves at speed; the torque step "
    "is the largest change between two control periods of 1 ms. Controller and "
    "`reachable_targets` with default settings ([reachable_targets.md](reachable_targets.md))."
)
