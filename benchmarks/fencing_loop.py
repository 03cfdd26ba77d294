"""The scenario `fencing` as a library loop: a humanoid of 28 joints on one fixed sole, no ROS."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

import ghc_controller as ghc
from ghc_controller.types import Array
from ghc_sim_bridge import SimulationDiverged, Simulator
from ghc_sim_bridge.scenario.fields import Scenario
from ghc_sim_bridge.scenario.references import ReferencePoint
from ghc_sim_bridge.scenario.robot_changes import write_changed_robot
from ghc_sim_bridge.scenario.scenario import load_scenario

SCENARIO = "fencing"
LARGEST_SPEED = 100.0  # [rad/s] norm of all joints: beyond it a run has stopped
LARGEST_TORQUE = 2e4  # [Nm] likewise
_EVERY = 30  # ticks between two points of a stored curve


class Fencing(NamedTuple):
    """One case: variant of the scenario, whether the posture is the last level, and how long."""

    variant: str
    posture: bool = True
    duration: float = 3.0  # [s]


def run_fencing(
    formulation: str, optimization: ghc.FormulationSettings, case: Fencing, curve: bool = False
) -> dict[str, Any]:
    """Figures of one run: errors in mm, torques in Nm, excess of joint limits in degrees.

    `tip_end` is the mean of the last quarter; all of them end where the run stopped.
    """
    scenario = load_scenario(SCENARIO, case.variant)
    controller = fencer(scenario, formulation, optimization, case.posture)
    simulator = Simulator(
        scenario.scene, scenario.control_dt, scenario.control_dt, controller.model.joint_names
    )
    start(controller, simulator, scenario)
    limits = controller.model.limits
    errors: list[list[float]] = []
    torques: list[Array] = []
    status: list[ghc.StepStatus] = []
    excess, qps, stopped = 0.0, 0, None
    while simulator.time < case.duration - 1e-9 and stopped is None:
        state = simulator.state()
        result = controller.step(state)
        found = {task.name: task.motion_error for task in controller.report().tasks}
        errors.append([1e3 * found[name] for name in ("sword_tip", "left_foot", "balance")])
        torques.append(result.torque.copy())
        status.append(result.status)
        qps += result.solution.qp_solved
        size = float(np.linalg.norm(result.torque))
        if size > LARGEST_TORQUE or np.linalg.norm(state.v) > LARGEST_SPEED:
            stopped = simulator.time
            break
        try:
            simulator.step(result.torque)
        except SimulationDiverged:
            stopped = simulator.time
            break
        q = simulator.state().q
        beyond = np.maximum(q - limits.position_upper, limits.position_lower - q)
        excess = max(excess, float(np.degrees(beyond.max())))
    tip, foot, balance = np.array(errors).T
    path = np.array(torques)
    figures = {
        "tip_max": tip.max(),
        "tip_end": tip[len(tip) * 3 // 4 :].mean(),
        "foot": foot.max(),
        "balance": balance.max(),
        "excess": excess,
        "torque": float(np.sqrt((path**2).sum(axis=1).mean())),
        "jump": float(np.abs(np.diff(path, axis=0)).max(initial=0.0)),
        "qps": qps,
        "not_solved": sum(each is not ghc.StepStatus.SOLVED for each in status),
        "failed": sum(each is ghc.StepStatus.FALLBACK for each in status),
        "stopped": stopped,
    }
    if curve:
        figures["curve"] = tip[::_EVERY].tolist()
    return figures


def fencer(
    scenario: Scenario,
    formulation: str,
    optimization: ghc.FormulationSettings,
    posture: bool = True,
) -> ghc.Controller:
    """Controller of the scenario's robot with its changes; without `posture` no last level."""
    hierarchy = scenario.phases[0].hierarchy
    given = scenario.parameters.get("controller", {})
    settings = ghc.Settings(
        formulation=formulation,
        control_dt=scenario.control_dt,
        hierarchy=hierarchy if posture else hierarchy.rpartition(" > ")[0],
        torque_rate_limit=scenario.torque_rate_limit,
        position_limits=given.get("position_limits", True),
        velocity_limits=given.get("velocity_limits", True),
        optimization=optimization,
    )
    source = ghc.load_robot(scenario.robot).path
    with TemporaryDirectory() as folder:
        changed = write_changed_robot(source, scenario.robot_changes, Path(folder) / "robot.yaml")
        return ghc.Controller(ghc.load_robot(changed), settings)


def start(controller: ghc.Controller, simulator: Simulator, scenario: Scenario) -> None:
    """Send all references, as an experiment does before time runs."""
    controller.observe(simulator.state())
    for trajectory in _references(controller, scenario):
        controller.add_reference(trajectory)


def _references(
    controller: ghc.Controller, scenario: Scenario
) -> Iterator[ghc.ReferenceTrajectory]:
    joints = controller.model.joint_names
    for reference in scenario.references:
        points = reference.points
        position = np.array([point.position for point in points])
        if reference.joints:
            position = position[:, [reference.joints.index(name) for name in joints]]
        yield ghc.ReferenceTrajectory.for_task(
            controller.references.task(reference.task),
            np.array([point.time for point in points]),
            position,
            velocity=_of(points, "velocity"),
            acceleration=_of(points, "acceleration"),
        )


def _of(points: Sequence[ReferencePoint], name: str) -> Array | None:
    """(p, m) values of all points; None where they have none."""
    values = [getattr(point, name) for point in points]
    return np.array(values) if all(values) else None
