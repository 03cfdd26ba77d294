"""Closed-loop simulation of an upper-body case, and the results of the run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from time import thread_time
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.upper_body_cases import ROBOT, SCENE, Case, elbow_gap, prepare
from ghc_controller.types import Array
from ghc_sim_bridge import Simulator

DT = 1e-3  # [s]
_ROWS = ("position", "orientation", "gap", "torque", "mixed", "qps", "cpu")


@dataclass(frozen=True, slots=True)
class Run:
    """What happened at each of T steps."""

    position: Array  # (T,) [m] error of the hand
    orientation: Array  # (T,) [rad]
    gap: Array  # (T,) [m] of the elbow from the obstacle
    torque: Array  # (T, n) [Nm]
    mixed: Array  # (T,) 1 where several orders are active
    qps: Array  # (T,)
    cpu: Array  # (T,) [s] of the formulation
    unsolved: int  # steps that are not SOLVED
    dt: float  # [s]


def run_case(
    case: Case,
    formulation: str,
    optimization: ghc.FormulationSettings,
    dt: float = DT,
    duration: float | None = None,
) -> Run:
    """Run a case with the simulator, torque rate limit off.

    Args:
        dt: [s] control period.
        duration: [s], that of the case by default.
    """
    settings = ghc.Settings(
        formulation=formulation,
        control_dt=dt,
        hierarchy=case.hierarchy,
        torque_rate_limit=0.0,
        optimization=optimization,
    )
    controller = ghc.Controller.for_robot(ROBOT, settings)
    counted = _Counted(controller)
    simulator = Simulator(SCENE, control_dt=dt, joint_names=controller.model.joint_names)
    state = simulator.state()
    controller.observe(state)
    prepare(case, controller)
    act = case.schedule()
    rows: dict[str, list[Any]] = {name: [] for name in _ROWS}
    names, unsolved = controller.robot.task_names, 0
    hand, turn = names.index("hand"), names.index("hand_orientation")
    for _ in range(round((duration or case.duration) / dt)):
        controller.observe(state)
        gap = elbow_gap(controller, state.time)
        act(controller, state.time, gap)
        counted.reset()
        result = controller.step(state)
        rows["position"].append(np.linalg.norm(controller.stack.error_of(hand)))
        rows["orientation"].append(np.linalg.norm(controller.stack.error_of(turn)))
        rows["gap"].append(gap)
        rows["torque"].append(result.torque.copy())
        rows["mixed"].append(len(controller.priorities.in_force.candidates) > 1)
        rows["qps"].append(counted.qps)
        rows["cpu"].append(counted.cpu)
        unsolved += result.status is not ghc.StepStatus.SOLVED
        simulator.step(result.torque)
        state = simulator.state()
    history = {name: np.array(values) for name, values in rows.items()}
    return Run(**history, unsolved=unsolved, dt=dt)


def figures(run: Run) -> dict[str, float | int | None]:
    """Results of a run, in the units of the table."""
    mixed = run.mixed.astype(bool)
    result: dict[str, float | int | None] = {
        "max_mm": 1e3 * float(run.position.max()),
        "integral_mm_s": 1e3 * run.dt * float(run.position.sum()),
        "end_mm": 1e3 * float(run.position[-1]),
        "turn_max_rad": float(run.orientation.max()),
        "gap_mm": 1e3 * float(run.gap.min()),
        "rate_nm_s": float(np.abs(np.diff(run.torque, axis=0)).max() / run.dt),
        "unsolved": run.unsolved,
    }
    for name, rows in (("one", ~mixed), ("mixed", mixed)):
        result[f"qps_{name}"] = float(run.qps[rows].mean()) if rows.any() else None
        result[f"cpu_{name}_us"] = 1e6 * float(np.median(run.cpu[rows])) if rows.any() else None
    return result


class _Counted:
    """QPs and processor time of the formulation since `reset`."""

    def __init__(self, controller: ghc.Controller) -> None:
        formulation = controller.formulation
        self._solver = formulation.solver
        self.reset()
        formulation.solve = self._timed(formulation.solve)  # type: ignore[method-assign]

    def reset(self) -> None:
        self._before, self.cpu = self._solver.qps, 0.0

    @property
    def qps(self) -> int:
        return self._solver.qps - self._before

    def _timed(self, function: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(function)
        def call(*arguments: Any) -> Any:
            start = thread_time()
            result = function(*arguments)
            self.cpu += thread_time() - start
            return result

        return call
