"""Target streams with jumps, jitter and loss, made into references that a robot can follow."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.ndimage import maximum_filter1d

import ghc_controller as ghc
from benchmarks.models import STUDY_ROBOTS, install_model, install_study_model
from benchmarks.study_results import shown
from benchmarks.targets.reachable_loop import DT, PLAN, Case, run_loop, run_reference
from benchmarks.targets.target_streams import (
    Channel,
    Conveyed,
    RandomStream,
    least_distance,
    position_at,
    teleoperation_curve,
)
from ghc_controller.reachable import JointLimitsOfMotion, ReachableReference
from ghc_controller.types import Array
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "reachable_targets"
TITLE = "Target streams: reachable references and teleoperation"
FORMULATIONS = ("cascade",)
_CASES = {
    "kuka_lwr": Case("kuka_lwr", "kuka_lwr", "end_effector"),
    "panda": Case(STUDY_ROBOTS / "panda.yaml", STUDY_ROBOTS / "panda_scene.yaml", "end_effector"),
    "icub_upper_body": Case("icub_upper_body", "icub_upper_body", "hand"),
}
_RATES = (10.0, 100.0)  # [Hz]
_LOOP_RATES = (10.0, 20.0, 50.0, 100.0)
_OPERATOR_RATES = (20.0, 50.0, 100.0)
_SEEDS = 2
_JUMPS = 3
_LOSS = 0.1  # [-] of the random streams
_IDEAL = Channel(100.0, 0.0, 0.0)
_STARTS = 25  # postures from which the nearest point is sought
_WINDOW = 1.0  # [s] about a time in which the twin's steps count: an answer may come 0.6 s apart
_SETTLED = 5.0  # [s] after a stream stands still
_OPERATOR = 7.0  # [s]
_MOVING = 2.0  # [s] from which on the operator moves at speed


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """References alone, random streams in closed loop, and an operator."""
    found = {}
    for name in formulations:
        cases = dict(list(_CASES.items())[:1]) if quick else _CASES
        if not quick:
            install_model("icub-models")
            install_study_model("example-robot-data")
        rates = (50.0,) if quick else _RATES
        found[name] = {
            "references": [
                _references(robot, case, rate, 1 if quick else _SEEDS)
                for robot, case in cases.items()
                for rate in rates
            ],
            "loops": []
            if quick
            else [row for robot, case in cases.items() for row in _loops(robot, case, name)],
            "operator": _operator(name, quick),
        }
    facts = {"seeds": 1 if quick else _SEEDS, "jumps": _JUMPS, "loss": _LOSS, "quick": quick}
    return {"facts": facts, "formulations": found}


def _start(case: Case) -> Array:
    model = ghc.load_robot(case.robot).model
    return Simulator(case.scene, joint_names=model.joint_names).state().q.copy()


def _stream(case: Case, seed: int) -> RandomStream:
    robot = ghc.load_robot(case.robot)
    task = next(task for task in robot.tasks if task.name == case.task)
    return RandomStream.draw(robot, task, _start(case), seed, _JUMPS)


def _references(robot_name: str, case: Case, rate: float, seeds: int) -> dict[str, Any]:
    """Shares of the limits that references use, and errors where streams stand still."""
    robot = ghc.load_robot(case.robot)
    task = next(task for task in robot.tasks if task.name == case.task)
    q, shares, errors, distances = _start(case), [], [], []
    random = np.random.default_rng(0)
    limits = JointLimitsOfMotion.of(robot.model, ReachableReference(robot, [case.task]).settings)
    limits = limits.containing(q)
    for seed in range(seeds):
        stream = _stream(case, seed)
        motion, _ = run_reference(case, stream, stream.end, Channel(rate, 0.005, _LOSS), seed, q)
        middle = 0.5 * (limits.lower + limits.upper)
        half = 0.5 * (limits.upper - limits.lower)
        shares.append(
            [
                (np.abs(motion[:, 0] - middle) / half).max(),
                (np.abs(motion[:, 1]) / limits.velocity).max(),
                (np.abs(motion[:, 2]) / limits.acceleration).max(),
            ]
        )
        end = motion[-1, 0]
        target = stream(stream.end)
        starts = [end, q, *(random.uniform(limits.lower, limits.upper) for _ in range(_STARTS))]
        least = least_distance(robot, task, target, limits, starts)
        distance = float(np.linalg.norm(position_at(robot, task, end) - target))
        errors.append(distance - least)
        distances.append(least)
    position, velocity, acceleration = np.max(shares, axis=0)
    return {
        "robot": robot_name,
        "rate": rate,
        "position": position,
        "velocity": velocity,
        "acceleration": acceleration,
        "error": max(errors),
        "out_of_reach": sum(d > 1e-3 for d in distances),
    }


def _loops(robot_name: str, case: Case, formulation: str) -> list[dict[str, Any]]:
    """Torque steps beside those of a twin that gets in continuous time what the samples convey."""
    rows = []
    stream = _stream(case, 1)
    for rate in _LOOP_RATES:
        channel = Channel(rate, 0.005, _LOSS)
        curve = Conveyed.by(stream, channel.samples(stream, stream.end, 1), PLAN * DT)
        twin = run_loop(case, curve, stream.end, _IDEAL, 1, formulation).step
        step = run_loop(case, stream, stream.end, channel, 1, formulation).step
        allowed = maximum_filter1d(twin, 2 * round(_WINDOW / DT) + 1)
        times = DT * np.arange(len(twin))
        still = times > stream.stands_from + _SETTLED
        ends = (*curve.known[1:], stream.end)
        responses = [
            (times >= begin) & (times < end) for begin, end in zip(curve.known, ends, strict=True)
        ]
        rows.append(
            {
                "robot": robot_name,
                "rate": rate,
                "twin": twin.max(),
                "largest": step.max(),
                "response": max(step[during].max() - twin[during].max() for during in responses),
                "excess": (step - allowed).max(),
                "still": step[still].max(),
            }
        )
    return rows


def _operator(formulation: str, quick: bool) -> list[dict[str, Any]]:
    """The KUKA follows a figure of eight at 0.13 m/s, stamped by the sender or by arrival."""
    case = _CASES["kuka_lwr"]
    robot = ghc.load_robot(case.robot)
    curve = teleoperation_curve(position_at(robot, robot.tasks[0], _start(case)))
    end = 2.5 if quick else _OPERATOR
    rows = []
    for stamped in (True,) if quick else (True, False):
        for rate in (50.0,) if quick else _OPERATOR_RATES:
            moving = run_loop(case, curve, end, Channel(rate), 1, formulation, stamped)
            moving = moving.after(_MOVING)
            rows.append(
                {
                    "rate": rate,
                    "stamps": "sender" if stamped else "arrival",
                    "mean": moving.error.mean(),
                    "largest": moving.error.max(),
                    "step": moving.step.max(),
                }
            )
    return rows


def table(result: dict[str, Any]) -> str:
    """Three tables per formulation."""
    parts = [_TEXT]
    for name, found in result["formulations"].items():
        parts.append(f"Formulation `{name}`:")
        parts.append(
            markdown_table(
                [
                    "robot",
                    "rate [Hz]",
                    "position, share of limit",
                    "velocity",
                    "acceleration",
                    "error to the reachable part [mm]",
                    "streams that end out of reach",
                ],
                [
                    [r["robot"], f"{r['rate']:g}"]
                    + [shown(r[k], ".3f") for k in ("position", "velocity", "acceleration")]
                    + [shown(1e3 * r["error"], ".3f"), str(r["out_of_reach"])]
                    for r in found["references"]
                ],
            )
        )
        parts.append(
            markdown_table(
                [
                    "robot",
                    "rate [Hz]",
                    "twin, largest [Nm per ms]",
                    "stream, largest",
                    "beyond the twin, from jump to jump",
                    "beyond the twin, at any time",
                    "standing still",
                ],
                [
                    [r["robot"], f"{r['rate']:g}"]
                    + [shown(r[k], ".4f") for k in ("twin", "largest", "response", "excess")]
                    + [shown(r["still"], ".1e")]
                    for r in found["loops"]
                ],
            )
        )
        parts.append(
            markdown_table(
                [
                    "rate [Hz]",
                    "stamps of",
                    "mean error [mm]",
                    "largest error [mm]",
                    "largest torque step [Nm per ms]",
                ],
                [
                    [f"{r['rate']:g}", r["stamps"]]
                    + [shown(1e3 * r[k], ".2f") for k in ("mean", "largest")]
                    + [shown(r["step"], ".4f")]
                    for r in found["operator"]
                ],
            )
        )
    return "\n\n".join(parts)


_TEXT = (
    "How references are made: [reachable_targets.md](reachable_targets.md). Random streams: "
    f"circles of 0.1 m/s about points that change by {_JUMPS} jumps, every third point out of "
    f"reach; 5 ms of jitter, {_LOSS:.0%} lost; then they stand still for 7 s. First table: shares "
    "of the limits that the reference uses (position: of half the range, inside its margin; 1 = "
    "at the limit), and where it ends: its distance from the target beyond the least that joint "
    f"limits allow (bounded least squares from {_STARTS + 2} postures). Second table: largest "
    "change of a torque between two control periods of 1 ms in closed loop (controller and rate "
    "limit with default settings, the task above a posture that gets that of the reference), "
    "beside a twin that gets in continuous time what the samples convey: the same curve at 100 Hz "
    "without jitter and loss, each jump when its first sample arrives (beyond 1 m when two more "
    "confirm it); *beyond the twin*: its largest step above the twin's largest one from each jump "
    f"to the next, and at any time above the twin's within {_WINDOW:g} s of it; *standing still*: "
    f"from {_SETTLED:g} s after the stream "
    "stands. Third table: an operator's figure of eight at 0.13 m/s on the KUKA, 5 ms of jitter, "
    "2 % lost, error against the curve at the same time once it moves at speed."
)
