"""Distance to moving obstacles as rows on joint accelerations."""

from __future__ import annotations

import numpy as np

from ghc_controller.constraints.constraint import Constraint, Rows, Softness, Space, Tick
from ghc_controller.core import native
from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.previews.motion import PlannedMotion
from ghc_controller.previews.preview import OBSTACLE_MOTION, Preview
from ghc_controller.types import Array


class ObstacleDistance(Constraint):
    """Keeps protected frames at their safe distance from virtual obstacles.

    Thesis, eq. 4.1 to 4.3, solved for the acceleration: with n the unit normal from obstacle to
    robot, d = n . (p_r - p_o) and the horizon dt (delta t there),

        n . J x >= 2 / dt^2 (d_s - d - n . (v_r - v_o) dt) - n . (dJ/dt v) + n . a_o

    keeps d at d_s or more after dt, if x and a_o stay. A longer horizon brakes earlier and
    softer. The rows are soft: they are relaxed before torques are.
    """

    space = Space.ACCELERATION
    softness = Softness.SOFT
    kind = OBSTACLE_MOTION

    def __init__(self, model: RobotModel, horizon: float, name: str = "obstacle") -> None:
        """`horizon` [s] > 0; InvalidValue otherwise."""
        super().__init__(name)
        if not (np.isfinite(horizon) and horizon > 0.0):
            raise InvalidValue(f"obstacle horizon {horizon} s given, more than 0 expected")
        self._model = model
        self.horizon = horizon
        self.reset()

    def reset(self) -> None:
        """Forget the plan."""
        self._plan: Preview | None = None
        self._frames: tuple[int, ...] = ()
        self._no_upper = np.zeros(0)
        self.names: tuple[str, ...] = ()

    def follow(
        self,
        preview: Preview,
        now: float | None = None,  # noqa: ARG002
    ) -> tuple[UnknownName, ...]:
        """Take a plan over, as far as its protected frames exist; obstacles not in it have gone.

        Returns:
            What is wrong with each frame whose obstacles were left out; empty when none was.

        Raises:
            InvalidValue: rows without their motions; the plan before stays.
        """
        if len(preview.motions) != len(preview.rows):
            raise InvalidValue(
                f"{preview.kind}: {len(preview.rows)} rows with {len(preview.motions)} motions "
                "given, a motion for each expected"
            )
        plan, known = preview, self._model.frame_names
        given = dict.fromkeys(entry.frame for entry in plan.motions)
        left_out = [frame for frame in given if frame not in known]
        if left_out:
            plan = plan.only([entry.frame not in left_out for entry in plan.motions])
        self._frames = tuple(self._model.frame_id(entry.frame) for entry in plan.motions)
        self.names = tuple(f"{self.name}.{entry.id}" for entry in plan.motions)
        self._no_upper = np.full(len(plan.motions), np.inf)
        self._plan = plan
        # One without a frame is for bodies alone (`BodyDistance.follow_obstacles`).
        return tuple(UnknownName("protected frame", frame, known) for frame in left_out if frame)

    def states(self, time: float) -> tuple[tuple[PlannedMotion, Array], ...]:
        """The obstacles with their virtual states (3, 3) at `time` [s]; rows as in the plan."""
        plan = self._plan
        if plan is None:
            return ()
        return tuple((entry, plan.motion_at(row, time)) for row, entry in enumerate(plan.motions))

    def is_stale(self, time: float) -> bool:
        """True when the plan has ended: its obstacles rest since then."""
        plan = self._plan
        return plan is not None and bool(plan.motions) and plan.has_ended(time)

    @property
    def is_idle(self) -> bool:
        """Whether there is no obstacle."""
        return not self.names

    def rows(self, tick: Tick) -> Rows | None:
        """A row for each obstacle; None without any."""
        plan = self._plan
        if plan is None or not plan.motions:
            return None
        matrix = np.empty((len(plan.motions), self._model.nv))
        lower = np.empty(len(plan.motions))
        for row, (entry, frame_id) in enumerate(zip(plan.motions, self._frames, strict=True)):
            state, frame = plan.motion_at(row, tick.state.time), self._model.frame(frame_id)
            motion = (frame.jacobian, frame.position, frame.velocity, frame.drift)
            lower[row] = native.distance_row(
                *motion, entry.normal, state, entry.safe_distance, self.horizon, matrix[row]
            )
        return Rows(matrix, lower, self._no_upper, self.names)
