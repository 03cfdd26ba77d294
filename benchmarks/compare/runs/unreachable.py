"""The KUKA with a target out of reach: does the arm come to rest, and how close?"""

from __future__ import annotations

import numpy as np

import ghc_controller as ghc
from benchmarks.compare.case import Result
from benchmarks.compare.method import Method
from benchmarks.compare.runs.closed_loop import Loop, Span, run_loop
from benchmarks.compare.runs.measures import measure
from benchmarks.switching_loop import target_references
from benchmarks.unreachable_loop import HIERARCHY, TARGET
from ghc_sim_bridge import Simulator

_ROBOT = "kuka_lwr"
_TASK = "end_effector"
_VELOCITY = 1.2  # [rad/s] limit, as in the scenario priority_switching
_DURATION, _QUICK = 10.0, 0.05  # [s]


def run_unreachable(method: Method, quick: bool) -> Result:
    """From rest to a target 0.58 m out of reach, default damping, torque rate limit off."""
    settings = ghc.Settings(
        formulation=method.formulation,
        hierarchy=HIERARCHY,
        velocity_limit=_VELOCITY,
        torque_rate_limit=0.0,
        optimization=method.settings(),
    )
    controller = ghc.Controller(ghc.load_robot(_ROBOT), settings)
    simulator = Simulator(_ROBOT, joint_names=controller.model.joint_names)
    controller.start(simulator.state())
    for reference in target_references(controller):
        if reference.task != _TASK:
            controller.add_reference(reference)
    controller.set_reference(_TASK, np.array(TARGET))
    matrix = ghc.matrix_from_hierarchy(controller.robot.task_names, HIERARCHY)
    span = Span(HIERARCHY, matrix.alpha, 0.0, _QUICK if quick else _DURATION)
    loop = Loop(controller, simulator, (span,))
    return measure(loop, run_loop(loop))
