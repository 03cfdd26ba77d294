"""The public names of the package, and the short way through the controller."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.hierarchy import matrix_from_hierarchy
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_sim_bridge import Simulator, load_scene

SOURCE = Path(__file__).resolve().parents[2] / "src" / "ghc_controller"
SWAP = "elbow > end_effector > posture"


def test_every_public_name_is_there() -> None:
    assert 20 <= len(ghc.__all__) <= 35
    for name in ghc.__all__:
        assert getattr(ghc, name) is not None
    assert set(ghc.__all__) <= set(dir(ghc))
    with pytest.raises(AttributeError, match="no attribute 'Regulator'"):
        ghc.Regulator  # noqa: B018
    assert load_scene("kuka_lwr").name == "kuka_lwr"


def test_one_version() -> None:
    for file in ("setup.py", "package.xml"):
        text = (SOURCE / file).read_text(encoding="utf-8")
        assert re.search(rf"version[=>]\"?{re.escape(ghc.__version__)}\b", text)


def test_the_short_way_is_the_long_way() -> None:
    """The same torques, to the last bit, over a swap of 0.2 s."""
    short = ghc.Controller(ghc.load_robot("kuka_lwr"))
    simulator = Simulator("kuka_lwr", joint_names=short.model.joint_names)
    short.start(simulator.state())
    short.set_reference("elbow", [0.05, -0.35, 0.48])
    assert short.change_hierarchy(SWAP, start=0.05, duration=0.1)
    assert not short.change_hierarchy(SWAP, start=0.05, duration=0.1)
    found = _torques(short, simulator)

    long = ghc.Controller.for_robot("kuka_lwr")
    simulator.reset()
    long.observe(simulator.state())
    task = long.references.task("elbow")
    target = task.static_target(np.array([0.05, -0.35, 0.48]))
    long.add_reference(ReferenceTrajectory.static(task, target))
    matrix = matrix_from_hierarchy(long.robot.task_names, SWAP)
    long.add_transition(ghc.Transition(matrix, start=0.05, duration=0.1), now=0.0)
    assert np.array_equal(_torques(long, simulator), found)
    assert short.report().errors == {t.name: t.motion_error for t in long.report().tasks}


def _torques(controller: ghc.Controller, simulator: Simulator) -> np.ndarray:
    torques = []
    while simulator.time < 0.2 - 1e-9:
        result = controller.step(simulator.state())
        simulator.step(result.torque)
        torques.append(result.torque)
    return np.array(torques)


def test_mistakes_are_named() -> None:
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"))
    with pytest.raises(ghc.GhcError, match=r"unknown task 'hand'.*end_effector, elbow, posture"):
        controller.set_reference("hand", [0.0, 0.0, 0.0])
    with pytest.raises(ghc.GhcError, match="3"):
        controller.set_reference("elbow", [0.0, 0.0])
    with pytest.raises(ghc.GhcError, match="unknown task 'hand'"):
        controller.change_hierarchy("hand > posture")
    with pytest.raises(ghc.GhcError, match="unknown robot 'panther'"):
        ghc.load_robot("panther")


def test_a_robot_in_python_is_that_of_the_file() -> None:
    """The same torques to 1e-12, over 60 random states. Seed 2."""
    written = ghc.load_robot("kuka_lwr")
    rest = dict(zip(written.model.joint_names, [0.0, 0.2, 0.1, 1.0, -0.4, -0.9, 0.0], strict=True))
    gains = {"stiffness": 30.0, "damping": 20.0}
    robot = ghc.Robot.from_urdf(
        written.urdf,
        tasks=[
            ghc.frame_position("end_effector", frame="tool", **gains),
            ghc.frame_position("elbow", frame="elbow", **gains),
            ghc.posture("posture", **gains, reference=rest),
        ],
        hierarchy="end_effector > elbow > posture",
        limits={"torque_rate": 1000.0},
    )
    assert robot.task_names == written.task_names
    controllers = [ghc.Controller(robot), ghc.Controller(written)]
    rng = np.random.default_rng(2)
    for tick in range(60):
        state = ghc.RobotState(1e-3 * tick, 0.5 * rng.normal(size=7), rng.normal(size=7))
        one, other = (controller.step(state) for controller in controllers)
        assert np.abs(one.torque - other.torque).max() <= 1e-12


def test_mistakes_in_a_robot_in_python_are_named() -> None:
    urdf = ghc.load_robot("kuka_lwr").urdf
    hand = ghc.frame_position("hand", frame="toll", stiffness=30.0, damping=20.0)
    with pytest.raises(ghc.GhcError, match=r"Robot.from_urdf: tasks\[0\].frame: 'toll' given"):
        ghc.Robot.from_urdf(urdf, [hand], "hand")
    unknown = ghc.TaskEntry("frame_speed", "hand", 30.0, 20.0)
    with pytest.raises(ghc.GhcError, match=r"'frame_speed' given; known: .*frame_position"):
        ghc.Robot.from_urdf(urdf, [unknown], "hand")


def test_a_reference_given_later_is_the_one_that_counts() -> None:
    """At once means now: it replaces one that was scheduled for a time that has passed."""
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"))
    q, v = np.full(7, 0.4), np.zeros(7)
    controller.start(ghc.RobotState(0.0, q, v))
    controller.set_reference("elbow", [0.1, 0.0, 0.5], start=0.5)
    controller.step(ghc.RobotState(1.0, q, v))
    at_first = controller.report().errors["elbow"]
    here = controller.references.task("elbow").current(controller.model)
    controller.set_reference("elbow", here)
    controller.step(ghc.RobotState(1.001, q, v))
    assert at_first > 0.01
    assert controller.report().errors["elbow"] < 1e-9
