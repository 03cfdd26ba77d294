"""The cases of RHP-HQP (Han et al., 2021) on the upper body of iCub."""

from __future__ import annotations

import ghc_controller as ghc
from benchmarks.compare.case import Result
from benchmarks.compare.method import Method
from benchmarks.compare.runs.closed_loop import Loop, Span, run_loop
from benchmarks.compare.runs.measures import measure
from benchmarks.upper_body_cases import CASES, ROBOT, SCENE, elbow_gap, prepare
from ghc_sim_bridge import Simulator

_DT = 2e-3  # [s]
_QUICK = 0.05  # [s]
_ORDERS = {"reactive": "hand_orientation > hand > waist = elbow_avoidance > posture"}


def run_upper_body(method: Method, quick: bool, name: str, w: float) -> Result:
    """One case with regularization w, `velocity_damping` 0 as in the papers, 2 ms.

    Errors stand by the levels of the order at the start; in case 3, of the one that is reached.
    `gap_m` is the least distance of the elbow from the obstacle.
    """
    case = CASES[name]
    settings = ghc.Settings(
        formulation=method.formulation,
        control_dt=_DT,
        hierarchy=case.hierarchy,
        torque_rate_limit=0.0,
        optimization=method.settings(regularization=w, velocity_damping=0.0),
    )
    controller = ghc.Controller(ghc.load_robot(ROBOT), settings)
    simulator = Simulator(SCENE, _DT, joint_names=controller.model.joint_names)
    controller.start(simulator.state())
    prepare(case, controller)
    change, gaps = case.schedule(), []

    def act(controller: ghc.Controller, time: float) -> None:
        gaps.append(elbow_gap(controller, time))
        change(controller, time, gaps[-1])

    order = _ORDERS.get(name, case.hierarchy)
    matrix = ghc.matrix_from_hierarchy(controller.robot.task_names, order)
    span = Span(order, matrix.alpha, 0.0, _QUICK if quick else case.duration)
    loop = Loop(controller, simulator, (span,), act)
    return measure(loop, run_loop(loop)) | {"gap_m": min(gaps)}
