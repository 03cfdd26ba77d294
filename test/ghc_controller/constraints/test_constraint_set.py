"""Merging of boxes: who binds, who gives way, and what is reported."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from model_states import make_model, random_state

from ghc_controller.constraints import (
    Box,
    BoxConstraint,
    Constraint,
    ConstraintSet,
    JointPositionLimit,
    JointVelocityLimit,
    Softness,
    Space,
    Tick,
    TorqueLimit,
    TorqueRateLimit,
)
from ghc_controller.constraints.obstacle import ObstacleDistance
from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.previews.motion import PlannedMotion
from ghc_controller.previews.preview import Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.types import Array, RobotState

DT = 1e-3  # [s]


class FixedBox(BoxConstraint):
    """A constant box on torques, of any softness."""

    space = Space.TORQUE

    def __init__(self, name: str, softness: Softness, lower: float, upper: float) -> None:
        super().__init__(name)
        self.softness = softness
        self._interval = (lower, upper)

    def write(self, tick: Tick, lower: Array, upper: Array) -> None:
        """The same interval for every joint."""
        assert tick.dt == DT
        lower[:], upper[:] = self._interval


def _torque_box(model: RobotModel, *constraints: Constraint) -> Box:
    state = RobotState(0.0, np.zeros(model.nq), np.zeros(model.nv))
    dynamics = model.update(state.q, state.v)
    return ConstraintSet(constraints, model).update(model, dynamics, state, None, DT).torque


def test_the_tightest_row_binds_and_is_named() -> None:
    """Each side has its own source; without any bound there is none."""
    model = make_model("kuka_lwr")
    box = _torque_box(
        model,
        FixedBox("wide", Softness.SOFT, -10.0, 2.0),
        FixedBox("low", Softness.HARD, -1.0, np.inf),
    )
    assert (box.bounds.lower == -1.0).all()
    assert (box.bounds.upper == 2.0).all()
    assert box.lower_name(2) == "low.joint_3"
    assert box.upper_name(2) == "wide.joint_3"
    assert box.slack == ()
    assert (box.hard.lower == -1.0).all()
    assert (box.hard.upper == np.inf).all()
    free = _torque_box(model)
    assert np.isinf(free.bounds.lower).all()
    assert free.upper_name(0) == ""


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_soft_rows_give_way_first_then_the_rate_and_torque_never(order: tuple[int, ...]) -> None:
    """Whatever the order given: hard, then rate as near as it can, then soft."""
    model = make_model("kuka_lwr")
    constraints = [
        FixedBox("torque", Softness.HARD, -1.0, 1.0),
        FixedBox("rate", Softness.RATE, 3.0, 5.0),
        FixedBox("soft", Softness.SOFT, -4.0, -2.0),
    ]
    box = _torque_box(model, *(constraints[i] for i in order))
    assert (box.bounds.lower == 1.0).all()
    assert (box.bounds.upper == 1.0).all()
    assert (box.hard.lower == -1.0).all()
    assert (box.hard.upper == 1.0).all()
    slack = {entry.name: entry.amount for entry in box.slack}
    assert slack == {f"rate.joint_{i}": 2.0 for i in range(1, 8)} | {
        f"soft.joint_{i}": 3.0 for i in range(1, 8)
    }


@pytest.mark.parametrize("seed", range(10))
def test_random_merges_are_ordered_and_report_the_distance(seed: int) -> None:
    """lower <= upper inside the hard box; slack is how far each box is from the merged one."""
    rng = np.random.default_rng(seed)
    model = make_model("kuka_lwr")
    boxes = [
        FixedBox(f"box_{i}", Softness(rng.integers(1, 3)), *np.sort(rng.normal(size=2)))
        for i in range(4)
    ]
    limit = FixedBox("limit", Softness.HARD, -0.5, 0.5)
    box = _torque_box(model, *boxes, limit)
    lower, upper = box.bounds.lower[0], box.bounds.upper[0]
    assert -0.5 <= lower <= upper <= 0.5
    slack = {entry.name: entry.amount for entry in box.slack}
    for given in boxes:
        low, high = given._interval
        distance = max(low - upper, lower - high, 0.0)
        assert slack.get(f"{given.name}.joint_1", 0.0) <= distance + 1e-12
        assert (distance > 0.0) == (f"{given.name}.joint_1" in slack)


def test_slack_is_gone_when_the_conflict_is() -> None:
    """The boxes are reused from tick to tick; nothing of an old conflict stays."""
    model = make_model("kuka_lwr")
    constraints = ConstraintSet([TorqueLimit(1.0, 7), TorqueRateLimit(1000.0, 7)], model)
    state = RobotState(0.0, np.zeros(7), np.zeros(7))
    dynamics = model.update(state.q, state.v)
    far, near = np.full(7, 5.0), np.zeros(7)
    assert len(constraints.update(model, dynamics, state, far, DT).torque.slack) == 7
    box = constraints.update(model, dynamics, state, near, DT).torque
    assert box.slack == ()
    assert np.allclose(box.bounds.upper, 1.0)


@pytest.mark.parametrize("seed", range(10))
def test_position_and_velocity_limits_are_compatible(seed: int) -> None:
    """From random states, too fast ones included, the merged box is not empty without slack."""
    rng = np.random.default_rng(seed)
    model = make_model("kuka_lwr")
    constraints = ConstraintSet(
        [
            JointPositionLimit(model.position_lower, model.position_upper, 5.0),
            JointVelocityLimit(1.2, 7, 0.02),
        ],
        model,
    )
    for _ in range(100):
        q = rng.uniform(-1.02, 1.02, 7) * model.position_upper
        v = rng.uniform(-1.5, 1.5, 7)
        dynamics = model.update(q, v)
        boxes = constraints.update(model, dynamics, RobotState(0.0, q, v), None, DT)
        assert boxes.acceleration.slack == ()


def test_active_rows_are_named() -> None:
    """At a bound, beyond it, and inside."""
    model, state = make_model("humanoid"), random_state("humanoid", np.random.default_rng(0))
    dynamics = model.update(state.q, state.v)
    constraints = ConstraintSet([JointVelocityLimit(2.0, model.na, 0.02)], model)
    box = constraints.update(model, dynamics, state, None, DT).acceleration
    values = np.zeros(model.nv)
    assert box.active(values) == ()
    values[8] = box.bounds.upper[8]
    values[6] = box.bounds.lower[6] - 1.0
    first, third = model.joint_names[0], model.joint_names[2]
    assert box.active(values) == (f"velocity_limit.{first}", f"velocity_limit.{third}")
    assert box.lower_name(0) == ""


def test_names_must_differ() -> None:
    """Two rows of one name could not be distinguished."""
    model = make_model("kuka_lwr")
    with pytest.raises(InvalidValue, match="'torque_limit' is given twice"):
        ConstraintSet([TorqueLimit(1.0, 7), TorqueLimit(2.0, 7)], model)


def _obstacles(*frames: str) -> Preview:
    """An obstacle at rest for each frame, at heights of 1 m, 2 m and so on."""
    obstacles = []
    for k, frame in enumerate(frames, start=1):
        state = np.zeros((3, 3))
        state[0, 2] = k
        fields = (f"box_{k}", frame, 0.1, np.array([0.0, 0.0, 1.0]), state)
        obstacles.append(PlannedMotion(*fields, np.zeros((0, 3)), PreviewStatus.RAW))
    return Preview.of_motions(0.0, 0.01, 2, tuple(obstacles))


def _tick(model: RobotModel, time: float) -> Tick:
    """The state of the last update of the model, at a time [s]."""
    state = RobotState(time, model.q.copy(), model.v.copy())
    return Tick(model, model.dynamics, state, None, DT)


def test_obstacles_of_frames_that_the_robot_lacks_are_left_out() -> None:
    """The rest of the plan is followed, this one and the next."""
    model = make_model("kuka_lwr")
    model.update(np.zeros(model.nq), np.zeros(model.nv))
    distance = ObstacleDistance(model, 0.1)
    known = ", ".join(model.frame_names)
    reasons = [str(error) for error in distance.follow(_obstacles("nose", "tool", "nose", "ear"))]
    assert reasons == [
        f"unknown protected frame '{name}'; known: {known}" for name in ("nose", "ear")
    ]
    ((entry, state),) = distance.states(0.0)
    assert (entry.id, state[0, 2]) == ("box_2", 2.0)
    rows = distance.rows(_tick(model, 0.0))
    assert rows is not None
    assert rows.names == distance.names == ("obstacle.box_2",)
    assert rows.matrix.shape == (1, model.nv)
    assert distance.follow(_obstacles("tool")) == ()
    assert distance.names == ("obstacle.box_1",)


def test_a_plan_for_unknown_frames_alone_has_no_rows() -> None:
    model = make_model("kuka_lwr")
    distance = ObstacleDistance(model, 0.1)
    assert len(distance.follow(_obstacles("nose"))) == 1
    assert distance.rows(_tick(model, 0.0)) is None
    assert not distance.is_stale(1.0)


def test_bounds_in_place_of_motions_do_not_remove_the_obstacles() -> None:
    """Nor motions the bounds: a preview of another shape is refused and the one before stays."""
    model = make_model("kuka_lwr")
    distance = ObstacleDistance(model, 0.1)
    distance.follow(_obstacles("tool"))
    with pytest.raises(InvalidValue, match="1 rows with 0 motions given"):
        distance.follow(replace(_obstacles("tool"), motions=()))
    assert distance.names == ("obstacle.box_1",)
    limit = TorqueLimit(50.0, 7, follows=model.joint_names)
    with pytest.raises(InvalidValue, match="motions given, bounds of joints expected"):
        limit.follow(_obstacles("tool"))
