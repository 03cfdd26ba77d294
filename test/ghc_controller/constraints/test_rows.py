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
from ghc_controller.constraints.row_stack import RowStack
from ghc_controller.constraints.rows.cartesian_wall import CartesianWall
from ghc_controller.constraints.rows.frame_angular_speed import FrameAngularSpeed
from ghc_controller.constraints.rows.frame_speed import FrameSpeed
from ghc_controller.constraints.rows.joint_coupling import JointCoupling
from ghc_controller.errors import ConfigurationError, InvalidValue, WrongSize
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.numerics.rotation import quaternion_from_matrix
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


@pytest.mark.parametrize("link", [0, -1])  # the base, and the end of a limb
@pytest.mark.parametrize("kind", [FrameSpeed, FrameAngularSpeed])
@pytest.mark.parametrize("robot", ROBOTS)
def test_the_row_of_a_speed_is_its_derivative(
    robot: str, kind: type[FrameSpeed], link: int
) -> None:
    rng = np.random.default_rng(8)
    model = make_model(robot)
    moving = [name for name in model.frame_names if model.chain(name)]
    state, frame = random_state(robot, rng), model.frame_id(moving[link])
    of = slice(3) if kind is FrameSpeed else slice(3, 6)
    limit, horizon, x = 0.3, 0.05, rng.normal(size=model.nv)
    speeds = []
    for t in (-STEP, 0.0, STEP):
        model.update(moved(robot, state.q, state.v * t + 0.5 * x * t * t), state.v + x * t)
        speeds.append(float(np.linalg.norm(model.frame(frame).velocity[of])))
    rows = kind("speed", frame, limit, horizon).rows(_tick(model, state))
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


def test_an_angular_speed_holds_in_the_loop() -> None:
    """The tool turns by 1.5 rad; MuJoCo's angular velocity stays below 0.4 rad/s to 1 %."""
    gains = {"stiffness": 30.0, "damping": 10.0}
    limit = {"kind": "frame_angular_speed", "name": "gently", "frame": "tool", "limit": 0.4}
    fastest = []
    for constraints in ([], [limit]):
        robot = ghc.Robot.from_urdf(
            ghc.load_robot("kuka_lwr").urdf,
            tasks=[ghc.frame_orientation("turn", "tool", **gains), ghc.posture("rest", **gains)],
            hierarchy="turn > rest",
            constraints=constraints,
        )
        simulator, controller = Simulator("kuka_lwr", control_dt=DT), ghc.Controller(robot)
        controller.start(simulator.state())
        here = simulator.frame_rotation("tool")
        c, s = np.cos(1.5), np.sin(1.5)
        turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ here
        controller.set_reference("turn", quaternion_from_matrix(turned))
        speeds, active = [], set()
        while simulator.time < 1.5:
            simulator.step(controller.step(simulator.state()).torque)
            if simulator.tick % 50 == 0:
                active |= set(controller.report().active_constraints)
            w = simulator.frame_jacobian("tool")[3:] @ simulator.state().v
            speeds.append(float(np.linalg.norm(w)))
        fastest.append(max(speeds))
    assert fastest[0] > 1.0
    assert fastest[1] < 0.4 * 1.01
    assert "gently" in active


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


def test_rows_on_torques_count_what_tasks_exert() -> None:
    """As under force control, where the torque is M x + h + J^T f."""
    model = ghc.load_robot("kuka_lwr").model
    row, upper = np.eye(7)[:1], np.array([5.0])
    limits = ConstraintSet([FixedRows(Space.TORQUE, Softness.SOFT, row, upper)], model)
    state = RobotState(0.0, np.full(7, 0.4), np.full(7, 0.1))
    free = model.update(state.q, state.v)
    force, jacobian = np.array([20.0]), np.linspace(0.1, 0.7, 7)[None]
    model.exert("a task", jacobian, force)
    limits.update(model, free, state, None, DT)
    assert limits.rows is not None
    np.testing.assert_allclose(limits.rows.matrix, free.mass_matrix[:1])
    np.testing.assert_allclose(limits.rows.upper, upper - free.bias[:1] - 20.0 * jacobian[0, :1])


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


class _Written(Constraint):
    """A row on forces whose matrix is one array, written anew from tick to tick."""

    space, softness = Space.FORCE, Softness.HARD

    def __init__(self, name: str, size: int) -> None:
        super().__init__(name)
        self.matrix, self.names = np.zeros((1, size)), (name,)

    def rows(self, tick: Tick) -> Rows | None:
        return Rows(self.matrix, -np.ones(1), np.ones(1), self.names)


def test_a_matrix_on_forces_that_is_written_in_place_is_read_at_every_state() -> None:
    robot = ghc.load_robot("icub")
    state = Simulator("icub_standing", control_dt=DT).state()
    controller = ghc.Controller(robot)
    controller.start(state)
    controller.step(state)
    contacts = controller.problem().contacts
    assert contacts is not None
    row = _Written("mine", contacts.force_jacobian.shape[0])
    model = controller.model
    stack, dynamics = RowStack([row]), model.update(state.q, state.v)
    for k in (1.0, 2.0):
        row.matrix[0, 0], row.names = k, (f"mine_{k:g}",)
        stack.update(Tick(model, dynamics, state, None, DT, contacts=contacts))
        found = stack.on_forces(contacts)
        assert found.force_matrix[0, 0] == k
        assert found.names == row.names


IN_CONTACT = sorted({"cascade", "balanced", "ghc", "hqp", "rhp_hqp", "hqp_transition"})


@pytest.fixture(scope="module")
def standing() -> tuple[ghc.Robot, RobotState]:
    """iCub on both feet, its contact forces unknown to a joint."""
    return ghc.load_robot("icub"), Simulator("icub_standing", control_dt=DT).state()


def _step(
    standing: tuple[ghc.Robot, RobotState],
    formulation: str,
    *constraints: Constraint,
    in_core: bool = True,
) -> tuple[ghc.Controller, ghc.StepResult]:
    robot, state = standing
    settings = ghc.Settings.of(torque_rate_limit=0.0, formulation=formulation)
    controller = ghc.Controller(_with(robot, *constraints), settings)
    controller.formulation.solver.lets_core_solve = in_core
    controller.start(state)
    return controller, controller.step(state)


def _knees(joints: tuple[str, ...]) -> Array:
    """(1, a) tau_left_knee + tau_right_knee."""
    return np.array([[float(name.endswith("_knee")) for name in joints]])


@pytest.mark.parametrize("softness", [Softness.SOFT, Softness.HARD])
@pytest.mark.parametrize("formulation", IN_CONTACT)
def test_rows_on_torques_bound_torques_in_contact(
    standing: tuple[ghc.Robot, RobotState], formulation: str, softness: Softness
) -> None:
    """What both knees give together, recomputed as M x + h - J^T f: 5 Nm less than without."""
    controller, free = _step(standing, formulation)
    matrix = _knees(controller.model.joint_names)
    sign = np.sign(matrix[0] @ free.torque)
    bound = float(sign * (matrix[0] @ free.torque)) - 5.0
    rows = FixedRows(Space.TORQUE, softness, sign * matrix, np.array([bound]))
    controller, result = _step(standing, formulation, rows)
    assert result.status is ghc.StepStatus.SOLVED
    problem, found = controller.problem(), result.solution
    assert problem.contacts is not None
    moved = problem.mass_matrix @ found.acceleration + problem.bias
    full = moved - problem.contacts.force_jacobian.T @ found.force
    assert np.abs(full[:6]).max() < 1e-5
    assert sign * (matrix[0] @ full[6:]) == pytest.approx(bound, abs=1e-5)
    assert "fixed.0" in controller.report().active_constraints
    answer = (found.acceleration, found.force, found.torque)
    assert largest_violation(problem, *answer, problem.torque) <= VIOLATION_TOLERANCE


def test_the_core_and_python_answer_rows_on_torques_alike(
    standing: tuple[ghc.Robot, RobotState],
) -> None:
    """The QPs of the levels in the core, and none of them there; beside a row on accelerations."""
    joints = standing[0].model.joint_names
    rows = FixedRows(Space.TORQUE, Softness.HARD, _knees(joints), np.array([-8.0]))
    row = np.eye(len(joints) + 6)[6:7]
    still = FixedRows(Space.ACCELERATION, Softness.SOFT, row, np.array([-0.1]), "still")
    answers = []
    for in_core in (True, False):
        controller, result = _step(standing, "cascade", rows, still, in_core=in_core)
        assert result.status is ghc.StepStatus.SOLVED
        assert {"fixed.0", "still.0"} <= set(controller.report().active_constraints)
        answers.append(result.torque)
    np.testing.assert_allclose(answers[0], answers[1], rtol=0.0, atol=1e-3)


def test_rows_on_torques_in_contact_are_relaxed_by_name_unless_they_are_hard(
    standing: tuple[ghc.Robot, RobotState],
) -> None:
    """tau_knees <= -8 and >= -4 [Nm] meet half-way; one of them HARD, the other gives it all."""
    matrix = _knees(standing[0].model.joint_names)
    below = FixedRows(Space.TORQUE, Softness.SOFT, matrix, np.array([-8.0]), "below")
    for softness, share in ((Softness.SOFT, 2.0), (Softness.HARD, 4.0)):
        above = FixedRows(Space.TORQUE, softness, -matrix, np.array([4.0]), "above")
        controller, result = _step(standing, "cascade", below, above)
        assert result.status is ghc.StepStatus.RELAXED
        slack = {one.name: one.amount for one in controller.report().slack}
        assert slack["below.0"] == pytest.approx(share, abs=1e-3)
        assert slack.get("above.0", 0.0) == pytest.approx(4.0 - share, abs=1e-3)
        assert matrix[0] @ result.torque == pytest.approx(-8.0 + share, abs=1e-3)


def test_rows_that_cannot_be_served_are_rejected_by_name() -> None:
    model = make_model("kuka_lwr")
    row, upper = np.ones((1, 7)), np.zeros(1)
    hard = FixedRows(Space.ACCELERATION, Softness.HARD, row, upper)
    with pytest.raises(InvalidValue, match="'fixed': rows on acceleration with softness HARD"):
        ConstraintSet([hard], model)
    rate = FixedRows(Space.TORQUE, Softness.RATE, row, upper)
    with pytest.raises(InvalidValue, match="'fixed': rows on torque with softness RATE given"):
        ConstraintSet([rate], model)
    small = ConstraintSet([FixedRows(Space.ACCELERATION, Softness.SOFT, row[:, :3], upper)], model)
    state = RobotState(0.0, np.zeros(7), np.zeros(7))
    with pytest.raises(WrongSize, match="constraint 'fixed': matrix"):
        small.update(model, model.update(state.q, state.v), state, None, DT)
    with pytest.raises(InvalidValue, match="follows no preview"):
        hard.follow(None)
    assert repr(hard) == "FixedRows('fixed', ACCELERATION, HARD)"


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
