"""Distance to moving obstacles as rows on joint accelerations."""

from __future__ import annotations

import numpy as np

from ghc_controller.constraints.motion_plan import MotionPlan, PlannedObstacle
from ghc_controller.errors import InvalidValue
from ghc_controller.formulations.problem import AccelerationRows
from ghc_controller.robot_model import RobotModel
from ghc_controller.types import Array


class ObstacleDistance:
    """Keeps protected frames at their safe distance from virtual obstacles.

    Thesis, eq. 4.1 to 4.3, solved for the acceleration: with n the unit normal from obstacle to
    robot, d = n . (p_r - p_o) and the horizon dt (delta t there),

        n . J x >= 2 / dt^2 (d_s - d - n . (v_r - v_o) dt) - n . (dJ/dt v) + n . a_o

    keeps d at d_s or more after dt, if x and a_o stay. A longer horizon brakes earlier and
    softer. The rows are soft: they give way before torques do.
    """

    def __init__(self, model: RobotModel, horizon: float) -> None:
        """`horizon` [s] > 0; InvalidValue otherwise."""
        if not (np.isfinite(horizon) and horizon > 0.0):
            raise InvalidValue(f"obstacle horizon {horizon} s given, more than 0 expected")
        self._model = model
        self._horizon = horizon
        self.reset()

    def reset(self) -> None:
        """Forget the plan."""
        self._plan: MotionPlan | None = None
        self._frames: tuple[int, ...] = ()
        self.names: tuple[str, ...] = ()

    def follow(self, plan: MotionPlan) -> None:
        """Take a plan over; obstacles that it leaves out have gone.

        Raises:
            UnknownName: a protected frame that the robot does not have.
        """
        self._frames = tuple(self._model.frame_id(entry.frame) for entry in plan.obstacles)
        self.names = tuple(f"obstacle.{entry.id}" for entry in plan.obstacles)
        self._plan = plan

    def states(self, time: float) -> tuple[tuple[PlannedObstacle, Array], ...]:
        """The obstacles with their virtual states (3, 3) at `time` [s]; rows as in the plan."""
        plan = self._plan
        if plan is None:
            return ()
        elapsed = max(time - plan.start, 0.0)
        return tuple((entry, entry.at(elapsed, plan.step)) for entry in plan.obstacles)

    def is_stale(self, time: float) -> bool:
        """True when the plan has ended: its obstacles rest since then."""
        plan = self._plan
        return plan is not None and bool(plan.obstacles) and time > plan.valid_until + 1e-9

    def rows(self, time: float) -> AccelerationRows | None:
        """Rows at the state of the last `model.update`; None without obstacles."""
        states = self.states(time)
        if not states:
            return None
        dt = self._horizon
        matrix = np.empty((len(states), self._model.nv))
        lower = np.empty(len(states))
        for row, ((entry, state), frame_id) in enumerate(zip(states, self._frames, strict=True)):
            frame, normal = self._model.frame(frame_id), entry.normal
            matrix[row] = normal @ frame.jacobian[:3]
            distance = normal @ (frame.position - state[0])
            approach = normal @ (frame.velocity[:3] - state[1])
            lower[row] = 2.0 / dt**2 * (entry.safe_distance - distance - approach * dt)
            lower[row] += normal @ (state[2] - frame.drift[:3])
        return AccelerationRows(matrix, lower, np.full(len(states), np.inf), self.names)
