"""Force rows of a position task: eq. 3, hysteresis, integral, a frictionless plane."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import make_model, random_state, rows_of

from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.tasks.force_control import ForceControl, ForceFields
from ghc_controller.tasks.frame import FramePositionTask
from ghc_controller.tasks.posture import PostureTask
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.types import Array, RobotState, TaskTarget

STIFFNESS, DAMPING = 30.0, 20.0  # [1/s^2], [1/s]


def _hybrid_task(model: RobotModel, **gains: float) -> FramePositionTask:
    """Position task with a force row; the force is asked for in full at once unless said."""
    gains = {"rise_time": 0.0} | gains
    settings = ForceFields(axes=("z",), contact="tool", **gains)
    force = ForceControl(model.frame_id("tool"), ("x", "y", "z"), settings)
    return FramePositionTask("hand", model, "tool", STIFFNESS, DAMPING, force=force)


def _measured(state: RobotState, time: float, force: float) -> RobotState:
    """The same state with the plane pushing the tool up with `force` [N]."""
    wrench = np.array([0.0, 0.0, force, 0.0, 0.0, 0.0])
    return RobotState(time, state.q, state.v, wrenches={"tool": wrench})


def _target(task: FramePositionTask, model: RobotModel, push: float) -> TaskTarget:
    """Stay where the tool is, 0.1 m aside, and push down with `push` [N]."""
    position = task.current(model) + np.array([0.1, 0.0, 0.0])
    return TaskTarget(position, np.zeros(3), np.zeros(3), np.array([0.0, 0.0, -push]))


def _inverse_inertia(model: RobotModel, jacobian: Array) -> Array:
    """Lambda^-1 = J M^-1 J^T."""
    return jacobian @ np.linalg.solve(model.dynamics.mass_matrix, jacobian.T)


def test_rows_switch_with_hysteresis() -> None:
    """To force above `threshold`, back below `release`, and stay in between."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(0))
    model.update(state.q, state.v)
    task = _hybrid_task(model, threshold=1.0, release=0.2)
    target = _target(task, model, 10.0)
    forces = [0.0, 0.5, 1.0, 1.1, 0.5, 0.2, 0.1, 0.5, 5.0, 0.0]
    expected = [0, 0, 0, 1, 1, 1, 0, 0, 1, 0]
    stack, counts = TaskStack([task], model.nv), []
    for k, force in enumerate(forces):
        stack.update(model, _measured(state, 1e-3 * k, force), [target])
        counts += stack.force_rows
    assert counts == expected


def test_without_reference_force_or_measurement_it_is_a_motion_task() -> None:
    """The rows equal those of a task that knows nothing of forces."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(1))
    model.update(state.q, state.v)
    plain = FramePositionTask("plain", model, "tool", STIFFNESS, DAMPING)
    task = _hybrid_task(model)
    target = _target(task, model, 10.0)
    no_force = TaskTarget(target.position, target.velocity, target.acceleration)
    expected = rows_of(plain, model, state, target)
    stack = TaskStack([task], model.nv)
    for now, wanted in (
        (_measured(state, 0.0, 20.0), no_force),
        (state, target),
        (_measured(state, 0.0, 0.5), target),
    ):
        stack.update(model, now, [wanted])
        assert stack.force_rows == [0]
        assert np.array_equal(stack.target, expected.target)
        assert np.array_equal(stack.error, expected.error)


def test_contact_rows_are_masked_and_the_force_is_exerted() -> None:
    """The normal row only stays still; J^T w_d joins the bias; errors have units."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(2))
    free = model.update(state.q, state.v)
    task = _hybrid_task(model, proportional=0.5)
    target = _target(task, model, 10.0)
    plain = FramePositionTask("plain", model, "tool", STIFFNESS, DAMPING)
    motion = rows_of(plain, model, state, target)
    rows = rows_of(task, model, _measured(state, 0.0, 6.0), target)
    wrench = np.array([0.0, 0.0, -10.0 + 0.5 * (-10.0 + 6.0)])
    assert np.array_equal(rows.target[:2], motion.target[:2])
    assert rows.target[2] == -model.frame_drift(model.frame_id("tool"))[2]
    assert np.allclose(model.dynamics.bias, free.bias + rows.jacobian.T @ wrench, atol=1e-12)
    assert np.allclose(rows.error, [motion.error[0], motion.error[1], -4.0], atol=1e-12)
    assert task.force_row_mask.tolist() == [False, False, True]


def test_free_acceleration_is_that_of_eq_3() -> None:
    """Without a plane, all rows get Lambda^-1 w_d on top of the masked motion law."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(3))
    free = model.update(state.q, state.v)
    task = _hybrid_task(model)
    rows = rows_of(task, model, _measured(state, 0.0, 10.0), _target(task, model, 10.0))
    x = np.linalg.lstsq(rows.jacobian, rows.target, rcond=None)[0]
    torque = model.dynamics.mass_matrix @ x + model.dynamics.bias
    dv = np.linalg.solve(free.mass_matrix, torque - free.bias)
    push = _inverse_inertia(model, rows.jacobian) @ np.array([0.0, 0.0, -10.0])
    assert np.allclose(rows.jacobian @ dv, rows.target + push, atol=1e-9)


def test_the_answer_of_the_surroundings_disturbs_no_joint() -> None:
    """Where the plane answers with -w_d, every joint accelerates as the controller computed."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(4))
    free = model.update(state.q, state.v)
    task = _hybrid_task(model)
    rows = rows_of(task, model, _measured(state, 0.0, 10.0), _target(task, model, 10.0))
    x = np.random.default_rng(5).normal(size=7)
    torque = model.dynamics.mass_matrix @ x + model.dynamics.bias
    answer = rows.jacobian.T @ np.array([0.0, 0.0, 10.0])
    dv = np.linalg.solve(free.mass_matrix, torque - free.bias + answer)
    assert np.allclose(dv, x, atol=1e-9)


def test_a_frictionless_plane_is_held_with_the_reference_force() -> None:
    """Closed loop on a stiff plane: force reached, no steady error in it, no joint runs away."""
    model = make_model("kuka_lwr")
    q, v = np.array([0.0, -0.6, 0.0, 1.6, 0.0, -0.9, 0.0]), np.zeros(7)
    frame, dt = model.frame_id("tool"), 1e-3
    model.update(q, v)
    start = model.frame_position(frame).copy()
    surface = start[2] - 0.005  # [m]
    settings = ForceFields(axes=("z",), contact="tool", integral=5.0)
    force = ForceControl(frame, ("x", "y", "z"), settings)
    task = FramePositionTask("hand", model, "tool", STIFFNESS, DAMPING, force=force)
    posture = PostureTask("posture", model, STIFFNESS, DAMPING, reference=q)
    aside = start + np.array([0.01, -0.01, -0.05])
    target = TaskTarget(aside, np.zeros(3), np.zeros(3), np.array([0.0, 0.0, -20.0]))
    push, fastest = 0.0, 0.0
    stack = TaskStack([task, posture], model.nv)
    targets = [target, posture.default_target(model)]
    for k in range(6000):
        state = _measured(RobotState(0.0, q, v), k * dt, push)
        free = model.update(q, v)
        stack.update(model, state, targets)
        jacobian, wanted, rest = stack.jacobian[:3], stack.target[:3], stack.target[3:]
        inverse = np.linalg.pinv(jacobian)
        x = inverse @ wanted
        x += rest - inverse @ (jacobian @ rest)
        torque = model.dynamics.mass_matrix @ x + model.dynamics.bias
        depth, speed = surface - model.frame_position(frame)[2], model.frame_velocity(frame)[2]
        push = max(0.0, 2e4 * depth - 30.0 * speed) if depth > 0.0 else 0.0  # [N]
        contact = jacobian.T @ np.array([0.0, 0.0, push])
        v = v + dt * np.linalg.solve(free.mass_matrix, torque - free.bias + contact)
        q = q + dt * v
        fastest = max(fastest, float(np.abs(v).max()))
    assert stack.force_rows == [1, 0]
    assert np.isclose(push, 20.0, atol=1e-2)
    assert np.linalg.norm(stack.error[:2]) < 1e-4  # [m]
    assert fastest < 0.5  # [rad/s]


def test_integral_grows_in_contact_only_and_does_not_wind_up() -> None:
    """Its share of w_d is bounded by |f_ref|, and a lost contact clears it."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(4))
    model.update(state.q, 0.0 * state.v)
    task = _hybrid_task(model, integral=50.0)
    target = _target(task, model, 10.0)
    stack = TaskStack([task], model.nv)

    def pushed(k: int, force: float) -> float:
        """w_d on the normal, recovered from the torque that carries it."""
        free = model.update(state.q, 0.0 * state.v)
        stack.update(model, _measured(state, 1e-3 * k, force), [target])
        if stack.force_rows == [0]:
            return np.nan
        carried = model.dynamics.bias - free.bias
        return float(np.linalg.lstsq(stack.jacobian.T, carried, rcond=None)[0][2])

    assert np.isclose(pushed(0, 8.0), -10.0)  # first tick of the contact
    assert np.isclose(pushed(1, 8.0), -10.0 - 50.0 * 2.0 * 1e-3)
    assert np.isclose(pushed(1, 8.0), -10.0 - 50.0 * 2.0 * 1e-3)  # a repeated state: same answer
    for k in range(2, 4000):
        last = pushed(k, 8.0)
    assert np.isclose(last, -20.0)  # |integral share| = |f_ref|
    assert np.isnan(pushed(4001, 0.0))
    assert np.isclose(pushed(4002, 8.0), -10.0)


def test_force_rises_from_zero_without_a_jump() -> None:
    """Half the force after half the rise time; no small step of time makes a large one of force.

    While little is asked for, little is felt: the contact is not given up for that.
    """
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(6))
    task = _hybrid_task(model, rise_time=0.1)
    model.update(state.q, state.v)
    target = _target(task, model, 10.0)
    pushes, stack = [], TaskStack([task], model.nv)
    for k in range(150):
        free = model.update(state.q, state.v)
        measured = 2.0 if k == 0 else 0.0 if k < 50 else 10.0
        stack.update(model, _measured(state, 1e-3 * k, measured), [target])
        assert stack.force_rows == [1]
        carried = model.dynamics.bias - free.bias
        pushes.append(float(np.linalg.lstsq(stack.jacobian.T, carried, rcond=None)[0][2]))
    assert abs(pushes[0]) < 1e-9
    assert np.isclose(pushes[50], -5.0)
    assert np.allclose(pushes[100:], -10.0)
    assert np.abs(np.diff(pushes)).max() < 10.0 * np.pi / 2.0 / 100.0 * 1.01


def test_reset_clears_contact_and_integral() -> None:
    """After reset a force between release and threshold is no contact."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(5))
    model.update(state.q, state.v)
    task = _hybrid_task(model)
    target = _target(task, model, 10.0)
    stack = TaskStack([task], model.nv)

    def force_rows(time: float, force: float) -> list[int]:
        stack.update(model, _measured(state, time, force), [target])
        return stack.force_rows.copy()

    assert force_rows(0.0, 5.0) == [1]
    assert force_rows(0.1, 0.5) == [1]
    stack.reset()
    assert force_rows(0.2, 0.5) == [0]


def test_stacks_of_one_task_share_no_contact() -> None:
    """Each has its own memory: a touch that one has seen is none to the other."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(5))
    model.update(state.q, state.v)
    task = _hybrid_task(model)
    target = _target(task, model, 10.0)
    first, second = TaskStack([task], model.nv), TaskStack([task], model.nv)
    first.update(model, _measured(state, 0.0, 5.0), [target])
    for stack, expected in ((first, [1]), (second, [0])):
        stack.update(model, _measured(state, 0.1, 0.5), [target])
        assert stack.force_rows == expected


def test_motion_rows_come_back_after_contact() -> None:
    """Gains and reference of the force rows are those of the task again, to the bit."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(7))
    model.update(state.q, state.v)
    task = _hybrid_task(model, damping=3.0)
    position = task.current(model) + 0.1
    target = TaskTarget(position, np.full(3, 0.2), np.full(3, 0.3), np.array([0.0, 0.0, -10.0]))
    stack = TaskStack([task], model.nv)
    rows = []
    for k, force in enumerate((0.0, 5.0, 5.0, 0.0)):
        stack.update(model, _measured(state, 1e-3 * k, force), [target])
        rows.append(stack.target.copy())
    assert np.array_equal(rows[0], rows[3])
    assert np.array_equal(rows[1], rows[2])
    frame = model.frame(model.frame_id("tool"))
    assert rows[1][2] == pytest.approx(-3.0 * frame.velocity[2] - frame.drift[2], abs=1e-12)
    assert np.array_equal(rows[1][:2], rows[0][:2])


def test_bad_settings_are_refused() -> None:
    """Force axis outside the task, release above threshold, negative gains."""
    with pytest.raises(InvalidValue, match=r"force axis 'z' given; rows of the task"):
        ForceControl(0, ("x", "y"), ForceFields(axes=("z",), contact="tool"))
    with pytest.raises(InvalidValue, match=r"release: 2.0 given, at most threshold 1.0 expected"):
        ForceFields(axes=("z",), contact="tool", threshold=1.0, release=2.0)
    with pytest.raises(InvalidValue, match=r"integral: a number >= 0 expected, -1\.0"):
        ForceFields(axes=("z",), contact="tool", integral=-1.0)
