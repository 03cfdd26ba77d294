"""The KUKA with one target, out of reach or not, as a library loop: torque rate, rest, jerk."""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.switching_loop import Timing, make_run, target_references
from ghc_sim_bridge import Simulator

TARGET = (1.1, 0.5, 1.1)  # [m] of the end effector: 0.58 m out of reach
HIERARCHY = "end_effector > elbow > posture"
_TASK = "end_effector"
_DT = 1e-3  # [s]
_CALM = 3.0  # [s] at the end of a run


def run_unreachable(
    formulation: str,
    optimization: ghc.FormulationSettings,
    duration: float,
    target: tuple[float, float, float] | None = TARGET,
    dt: float = _DT,
) -> dict[str, Any]:
    """Figures of one run from rest, torque rate limit off, velocity limit of the scenario.

    Args:
        duration: [s].
        target: [m] of the end effector; None = that of the scenario, within reach.
        dt: [s] control period.

    Returns:
        error [m] of the end effector at the end, torque_rate [Nm/s], speed [rad/s] (mean
        abs(v) over the last 3 s), jerk: sum of abs(change of acceleration) [rad/s^2].
    """
    plan = make_run(Timing())
    settings = ghc.Settings(
        formulation=formulation,
        control_dt=dt,
        velocity_limit=plan.scenario.parameters["controller"]["velocity_limit"],
        torque_rate_limit=0.0,
        optimization=optimization,
    )
    controller = ghc.Controller.for_robot(plan.scenario.robot, settings)
    simulator = Simulator(
        plan.scenario.scene, control_dt=dt, joint_names=controller.model.joint_names
    )
    controller.observe(simulator.state())
    for reference in target_references(controller):
        controller.add_reference(reference)
    if target is not None:
        task = controller.references.task(_TASK)
        goal = task.static_target(np.array(target))
        controller.add_reference(ghc.ReferenceTrajectory.static(task, goal))
    matrix = ghc.matrix_from_hierarchy(controller.robot.task_names, HIERARCHY)
    controller.add_transition(ghc.Transition(matrix, 0.0, 0.0, hierarchy=HIERARCHY), 0.0)
    torque, velocity, acceleration = [], [], []
    for _ in range(round(duration / dt)):
        result = controller.step(simulator.state())
        torque.append(result.torque.copy())
        simulator.step(result.torque)
        velocity.append(simulator.state().v.copy())
        acceleration.append(simulator.acceleration.copy())
    errors = {entry.name: entry.motion_error for entry in controller.report().tasks}
    calm = np.abs(velocity[-round(_CALM / dt) :])
    return {
        "error": float(errors[_TASK]),
        "torque_rate": float(np.abs(np.diff(torque, axis=0)).max() / dt),
        "speed": float(calm.mean()),
        "jerk": float(np.abs(np.diff(acceleration, axis=0)).sum()),
    }
