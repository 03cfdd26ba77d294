"""General rows as constraints: against finite differences, in the loop, and when relaxed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from model_states import ROBOTS, make_model, moved, random_state

import ghc_controller as ghc
from ghc_controller.constraints import (
    BoxConstraint,
    Constraint,
    ConstraintSet,
    Rows,
    Softness,
    Space,
    Tick,
)
from ghc_controller.constraints.registry import CONSTRAINTS, ConstraintFields, register_constraint
from ghc_controller.constraints.rows.cartesian_wall import CartesianWall
from ghc_controller.constraints.rows.frame_speed import FrameSpeed
from ghc_controller.constraints.rows.joint_coupling import JointCoupling
from ghc_controller.errors import ConfigurationError, InvalidValue, WrongSize
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.problem.violation import largest_violation
from ghc_controller.qp import VIOLATION_TOLERANCE
from ghc_controller.robot.library import find_robot
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.types import Array, RobotState
from ghc_sim_bridge.simulation.simulator import Simulator

DT = 1e-3  # [s]
STEP = 1e-4  # [s] of finite differences


def _tick(model: RobotModel, state: RobotState) -> Tick:
    return Tick(model, model.update(state.q, state.v), state, None, DT)


def _wall(model: RobotModel, rng: np.random.Generator) -> CartesianWall:
    frame = model.frame_id(model.frame_names[-1])
    return CartesianWall("wall", frame, rng.normal(size=3), rng.normal(size=3), 0.1)


def _coupling(model: RobotModel, rng: np.random.Generator) -> JointCoupling:
    names = model.joint_names[:3]
    return JointCoupling("sum", model, dict(zip(names, rng.normal(size=3), strict=True)), -2.0)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("make", [_wall, _coupling])
def test_jacobian_and_drift_are_the_second_derivative_of_the_scalar(robot: str, make: Any) -> None:
    """d(q(t)) along q' = v + x t: central differences in t."""
    rng = np.random.default_rng(7)
    model = make_model(robot)
    constraint, state = make(model, rng), random_state(robot, rng)
    for _ in range(5):
        x = rng.normal(size=model.nv)
        values = []
        for t in (-STEP, 0.0, STEP):
            q = moved(robot, state.q, state.v * t + 0.5 * x * t * t)
            values.append(constraint.measure(_tick(model, RobotState(0.0, q, state.v))).value)
        d = constraint.measure(_tick(model, state))
        assert d.rate == pytest.approx((values[2] - values[0]) / (2.0 * STEP), abs=1e-6)
        second = (values[2] - 2.0 * values[1] + values[0]) / STEP**2
        assert d.jacobian @ x + d.drift == pytest.approx(second, abs=1e-5)


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_row_of_a_speed_is_its_derivative(robot: str) -> None:
    rng = np.random.default_rng(8)
    model = make_model(robot)
    state, frame = random_state(robot, rng), model.frame_id(model.frame_names[-1])
    limit, horizon, x = 0.3, 0.05, rng.normal(size=model.nv)
    speeds = []
    for t in (-STEP, 0.0, STEP):
        model.update(moved(robot, state.q, state.v * t + 0.5 * x * t * t), state.v + x * t)
        speeds.append(float(np.linalg.norm(model.frame(frame).velocity[:3])))
    rows = FrameSpeed("speed", frame, limit, horizon).rows(_tick(model, state))
    change = (speeds[2] - speeds[0]) / (2.0 * STEP)
    slack = rows.upper[0] - rows.matrix[0] @ x
    assert slack == pytest.approx((limit - speeds[1]) / horizon - change, abs=1e-5)


def _arm(*constraints: dict[str, Any]) -> ghc.Robot:
    robot = ghc.load_robot("kuka_lwr")
    return ghc.Robot.from_urdf(
        robot.urdf,
        tasks=[
            ghc.frame_position("hand", "tool", stiffness=30.0, damping=20.0),
            ghc.posture("posture", stiffness=30.0, damping=20.0),
        ],
        hierarchy="hand > posture",
        constraints=constraints,
    )


def _with(robot: ghc.Robot, *constraints: Constraint) -> ghc.Robot:
    return replace(robot, constraints=constraints)


def _run(
    robot: ghc.Robot, shift: Array, seconds: float, **settings: Any
) -> tuple[ghc.Controller, Array, Array, set[str], Array]:
    """Reach for a point that is away by `shift` (3,) [m].

    Returns:
        The controller, positions and speeds of the hand [m], [m/s], names of active constraints,
        and torque rates [Nm/s] after the first step.
    """
    simulator = Simulator("kuka_lwr", control_dt=DT)
    controller = ghc.Controller(robot, ghc.Settings.of(**settings))
    controller.start(simulator.state())
    model = controller.model
    frame = model.frame_id("tool")
    start = model.frame_position(frame).copy()
    controller.set_reference("hand", (start + shift).tolist())
    places, speeds, torques = [], [], []
    active: set[str] = set()
    for k in range(round(seconds / DT)):
        result = controller.step(simulator.state())
        assert result.status is not ghc.StepStatus.FALLBACK
        places.append(model.frame_position(frame) - start)
        speeds.append(np.linalg.norm(model.frame_velocity(frame)[:3]))
        torques.append(result.torque)
        if k % 50 == 0:
            active.update(controller.report().active_constraints)
        simulator.step(result.torque)
    rates = np.abs(np.diff(torques, axis=0)) / DT
    return controller, np.array(places), np.array(speeds), active, rates


@pytest.mark.parametrize("rate", [-1.0, 0.0])
def test_the_hand_stops_at_a_wall_that_its_target_is_behind(rate: float) -> None:
    """With and without a torque rate limit, which the bound plans with; then it stands there."""
    free = _arm()
    model = free.model
    simulator = Simulator("kuka_lwr", control_dt=DT)
    state = simulator.state()
    model.update(state.q, state.v)
    start = model.frame_position(model.frame_id("tool"))
    wall = {
        "kind": "cartesian_wall",
        "name": "wall",
        "frame": "tool",
        "point": (start - [0.0, 0.1, 0.0]).tolist(),
        "normal": [0.0, 1.0, 0.0],
    }
    shift = np.array([0.0, -0.3, 0.0])
    _, places, _, active, _ = _run(free, shift, 2.0, torque_rate_limit=rate)
    assert places[:, 1].min() < -0.2
    assert "wall" not in active
    controller, places, _, active, rates = _run(_arm(wall), shift, 2.0, torque_rate_limit=rate)
    assert places[:, 1].min() > -0.1 - 2e-4, "excess over the wall [m]"
    assert places[-1, 1] < -0.1 + 2e-3, "it goes there all the same"
    assert "wall" in active
    assert controller.counts["relaxed_ticks"] == 0
    if rate < 0.0:
        assert rates.max() <= 1000.0 + 1e-6


def test_a_coupling_and_a_speed_hold_in_the_loop() -> None:
    free, places, speeds, _, _ = _run(_arm(), np.array([0.0, -0.3, 0.0]), 1.5)
    names = free.model.joint_names
    assert speeds.max() > 0.3
    total = abs(float(free.model.q[0] + free.model.q[2]))
    simulator = Simulator("kuka_lwr", control_dt=DT)
    start = float(simulator.state().q[0] + simulator.state().q[2])
    assert abs(total - start) > 0.05
    robot = _arm(
        {
            "kind": "joint_coupling",
            "name": "sum",
            "coefficients": {names[0]: 1.0, names[2]: 1.0},
            "lower": start - 0.05,
            "upper": start + 0.05,
        },
        {"kind": "frame_speed", "name": "slow", "frame": "tool", "limit": 0.15},
    )
    controller, places, speeds, active, _ = _run(robot, np.array([0.0, -0.3, 0.0]), 3.0)
    assert speeds.max() < 0.15 * 1.01
    assert abs(float(controller.model.q[0] + controller.model.q[2]) - start) < 0.05 + 1e-4
    assert {"slow", "sum"} <= active
    assert places[-1, 1] < -0.2


class FixedRows(Constraint):
    """Constant rows."""

    def __init__(
        self,
        space: Space,
        softness: Softness,
        matrix: Array,
        upper: Array,
        name: str = "fixed",
    ) -> None:
        super().__init__(name)
        self.space, self.softness = space, softness
        self._rows = Rows(
            matrix,
            np.full_like(upper, -np.inf),
            upper,
            tuple(f"{name}.{k}" for k in range(len(upper))),
        )

    def rows(self, tick: Tick) -> Rows:
        """The same at each state."""
        return self._rows


def test_rows_that_exclude_each_other_are_relaxed_by_name_before_torques() -> None:
    """x_1 >= 30 and x_1 <= -30 meet half-way; x_2 >= 1e5 goes as far as the torque rate allows."""
    names = ("above", "below", "far")
    rows = np.zeros((3, 1, 7))
    rows[0, 0, 0], rows[1, 0, 0], rows[2, 0, 1] = -1.0, 1.0, -1.0
    uppers = (-30.0, -30.0, -1e5)
    constraints = [
        FixedRows(Space.ACCELERATION, Softness.SOFT, row, np.array([upper]), name)
        for name, row, upper in zip(names, rows, uppers, strict=True)
    ]
    state = Simulator("kuka_lwr", control_dt=DT).state()
    controller = ghc.Controller(
        _with(_arm(), *constraints[:2]), ghc.Settings(torque_rate_limit=0.0)
    )
    controller.start(state)
    result = controller.step(state)
    assert result.status is ghc.StepStatus.RELAXED
    slack = {one.name: one.amount for one in controller.report().slack}
    assert {"above.0", "below.0"} <= set(slack)
    assert slack["above.0"] + slack["below.0"] == pytest.approx(60.0, abs=1e-3)
    controller = ghc.Controller(_with(_arm(), constraints[2]))
    controller.start(state)
    result = controller.step(state)
    assert result.status is ghc.StepStatus.RELAXED
    assert not result.solution.rate_gave_way
    assert "far.0" in {one.name for one in controller.report().slack}
    problem = controller.problem()
    assert (result.torque <= problem.torque.upper + 1e-6).all()
    assert (result.torque >= problem.torque.lower - 1e-6).all()


@pytest.mark.parametrize("formulation", ["cascade", "balanced", "hqp"])
def test_rows_on_torques_bound_torques(formulation: str) -> None:
    """tau_1 + tau_2 of the answer is at the bound that the free answer exceeds."""
    state = Simulator("kuka_lwr", control_dt=DT).state()
    matrix = np.zeros((1, 7))
    matrix[0, 1], matrix[0, 3] = 1.0, 1.0

    def answer(robot: ghc.Robot) -> tuple[ghc.Controller, Array]:
        controller = ghc.Controller(
            robot, ghc.Settings.of(torque_rate_limit=0.0, formulation=formulation)
        )
        controller.start(state)
        controller.set_reference("hand", (np.array([0.3, 0.3, 0.5])).tolist())
        return controller, controller.step(state).torque

    _, free = answer(_arm())
    bound = float(matrix[0] @ free) - 1.0
    rows = FixedRows(Space.TORQUE, Softness.SOFT, matrix, np.array([bound]))
    controller, torque = answer(_with(_arm(), rows))
    assert matrix[0] @ torque == pytest.approx(bound, abs=1e-5)
    assert "fixed.0" in controller.report().active_constraints


def test_rows_on_forces_bound_the_forces_of_contacts() -> None:
    """iCub stands with 20 N less on the left foot, though nothing else asks for it."""
    robot = ghc.load_robot("icub")

    class LessOnTheLeft(Constraint):
        """F_left - F_right <= -20 N."""

        space, softness = Space.FORCE, Softness.HARD

        def rows(self, tick: Tick) -> Rows | None:
            """One row while both feet are on."""
            if tick.contacts is None:
                return None
            forces = dict(tick.contacts.forces)
            if not {"left_sole", "right_sole"} <= set(forces):
                return None
            row = np.zeros((1, tick.contacts.force_jacobian.shape[0]))
            for name, sign in (("left_sole", 1.0), ("right_sole", -1.0)):
                row[0, forces[name]][2::3] = sign
            return Rows(row, np.array([-np.inf]), np.array([-20.0]), (self.name,))

    simulator = Simulator("icub_standing", control_dt=DT)
    state = simulator.state()
    loads = []
    for constraints in ((), (LessOnTheLeft("less"),)):
        controller = ghc.Controller(_with(robot, *constraints), ghc.Settings(torque_rate_limit=0))
        controller.start(state)
        result = controller.step(state)
        assert result.status is ghc.StepStatus.SOLVED
        report = controller.report()
        loads.append(dict(zip(report.loads.names, report.loads.normal, strict=True)))
        problem = controller.problem()
        solution = result.solution
        answer = (solution.acceleration, solution.force, solution.torque)
        assert largest_violation(problem, *answer, problem.torque) <= VIOLATION_TOLERANCE
    assert loads[0]["left_sole"] - loads[0]["right_sole"] > -20.0
    assert loads[1]["left_sole"] - loads[1]["right_sole"] == pytest.approx(-20.0, abs=1e-4)
    assert "less" in report.active_constraints


def test_rows_that_cannot_be_served_are_rejected_by_name() -> None:
    model = make_model("kuka_lwr")
    row, upper = np.ones((1, 7)), np.zeros(1)
    hard = FixedRows(Space.ACCELERATION, Softness.HARD, row, upper)
    with pytest.raises(InvalidValue, match="'fixed': rows on acceleration with softness HARD"):
        ConstraintSet([hard], model)
    torque = FixedRows(Space.TORQUE, Softness.SOFT, row, upper)
    with pytest.raises(InvalidValue, match="'fixed': rows on torques are served for robots with"):
        ConstraintSet([torque], model, in_contact=True)
    small = ConstraintSet([FixedRows(Space.ACCELERATION, Softness.SOFT, row[:, :3], upper)], model)
    state = RobotState(0.0, np.zeros(7), np.zeros(7))
    with pytest.raises(WrongSize, match="constraint 'fixed': matrix"):
        small.update(model, model.update(state.q, state.v), state, None, DT)
    with pytest.raises(InvalidValue, match="follows no preview"):
        hard.follow(None)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"kind": "wall"}, "cartesian_wall"),
        ({"kind": "torque_limit"}, "switched on by settings"),
        ({"frame": "nose"}, "nose"),
        ({"normal": [0.0, 0.0, 0.0]}, "a direction expected"),
        ({"brake": 0.0}, "brake"),
        ({"thickness": 1.0}, "thickness"),
    ],
)
def test_a_wrong_entry_is_rejected_with_its_field(changes: dict[str, Any], words: str) -> None:
    wall = {"kind": "cartesian_wall", "name": "wall", "frame": "tool", "point": [0.0, 0.0, 0.0]}
    with pytest.raises(ConfigurationError, match=words):
        _arm(wall | {"normal": [0.0, 1.0, 0.0]} | changes)


def test_robot_yaml_lists_constraints(tmp_path: Path) -> None:
    """Names have to differ, also from those of every robot."""
    file = find_robot("kuka_lwr")
    text = file.read_text().replace("urdf: ", f"urdf: {file.parent}/")
    entry = "  - {name: NAME, kind: frame_speed, frame: tool, limit: 0.2}\n"
    path = tmp_path / "robot.yaml"
    path.write_text(f"{text}\nconstraints:\n{entry.replace('NAME', 'slow')}")
    controller = ghc.Controller(ghc.load_robot(path))
    assert "slow" in [one.name for one in controller.constraints.constraints]
    path.write_text(f"{text}\nconstraints:\n{2 * entry.replace('NAME', 'slow')}")
    with pytest.raises(ConfigurationError, match="'slow' is already taken"):
        ghc.load_robot(path)
    path.write_text(f"{text}\nconstraints:\n{entry.replace('NAME', 'friction')}")
    with pytest.raises(InvalidValue, match="'friction' is given twice"):
        ghc.Controller(ghc.load_robot(path))


def test_a_box_in_one_file_is_a_kind_of_robot_yaml(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is merged with the boxes of every robot, and named by joint."""
    assert "cartesian_wall" in CONSTRAINTS.built_in
    monkeypatch.setattr(CONSTRAINTS, "_registered", dict(CONSTRAINTS._registered))

    @register_constraint("calm")
    class Calm(BoxConstraint):
        """|x| <= 0.01 rad/s^2 of all joints."""

        entry = ConstraintFields
        space, softness = Space.ACCELERATION, Softness.SOFT

        @classmethod
        def from_config(cls, fields: Fields, model: RobotModel) -> BoxConstraint:  # noqa: ARG003
            return cls(read(fields, ConstraintFields).name)

        def write(self, tick: Tick, lower: Array, upper: Array) -> None:
            lower[:], upper[:] = -0.01, 0.01

    state = Simulator("kuka_lwr", control_dt=DT).state()
    controller = ghc.Controller(_arm({"kind": "calm", "name": "still"}))
    controller.start(state)
    controller.set_reference("hand", [0.3, 0.3, 0.5])
    result = controller.step(state)
    assert np.abs(result.solution.acceleration).max() == pytest.approx(0.01, abs=1e-7)
    assert "still.joint_1" in controller.report().active_constraints
