"""The executable `reference`: targets, moves and paths by hand, and what it prints of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from printed import words

from ghc_controller.errors import ConfigurationError
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.robot.library import load_robot
from ghc_controller.ros.by_hand.move import Move
from ghc_controller.ros.by_hand.reference import main
from ghc_controller.ros.by_hand.reference_request import reference_message, same_target
from ghc_controller.ros.conversions.requests import reference_from_message

WAIT = 120.0  # [s] wall
NEAR = ("0.45", "0.1", "0.7")  # [m] of the end effector


@pytest.fixture
def robot(start_node: Callable[..., Any]) -> Callable[..., Any]:
    """A simulated arm under control; starts `reference` with arguments."""
    patience = ("-p", f"lockstep_timeout:={WAIT}")
    start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", "-p", "scene:=kuka_lwr", *patience)
    start_node("ghc_controller", "controller", "--ros-args", "-p", "robot:=kuka_lwr")
    return lambda *arguments: start_node("ghc_controller", "reference", *arguments)


def _times(output: str) -> list[float]:
    return [float(line.split()[2]) for line in output.splitlines()]


def test_a_target_is_followed_until_it_is_reached(robot: Callable[..., Any]) -> None:
    run = robot("end_effector", *NEAR, "--duration", "1.5")
    assert run.wait(WAIT) == 0, run.output
    in_force, sent, reached = words(run.output)
    assert in_force.startswith("current end_effector at ")
    assert sent == "SENT end_effector to 0.45 0.1 0.7 over 1.5 s"
    assert reached.startswith("REACHED end_effector at 0.45 0.1 0.7, error ")
    assert float(reached.split()[-1]) <= 1e-3
    start, _, end = _times(run.output)
    assert end - start > 1.5
    again = robot("end_effector", *NEAR)
    assert again.wait(WAIT) == 0, again.output
    assert words(again.output)[1] == "SENT end_effector to 0.45 0.1 0.7"


def test_a_speed_gives_the_duration_of_the_move(robot: Callable[..., Any]) -> None:
    run = robot("end_effector", *NEAR, "--velocity", "0.2")
    assert run.wait(WAIT) == 0, run.output
    in_force, sent, _ = words(run.output)
    start = np.array([float(part.strip(",")) for part in in_force.split(" at ")[1].split()[:3]])
    distance = float(np.linalg.norm(np.array(NEAR, dtype=float) - start))
    over = float(sent.split(" over ")[1].removesuffix(" s"))
    assert over == pytest.approx(1.875 * distance / 0.2, rel=1e-3)


def test_a_file_is_followed_to_its_last_point(robot: Callable[..., Any], tmp_path: Path) -> None:
    file = tmp_path / "path.csv"
    file.write_text("time,x,y,z\n0,0.4,0,0.7\n1,0.45,0.1,0.7\n2,0.5,0.1,0.7\n", encoding="utf-8")
    run = robot("end_effector", "--file", file)
    assert run.wait(WAIT) == 0, run.output
    _, sent, reached = words(run.output)
    assert sent == "SENT end_effector to 0.5 0.1 0.7 over 2 s"
    assert reached.startswith("REACHED end_effector at 0.5 0.1 0.7, error ")
    joints = tmp_path / "joints.yaml"
    names = ", ".join(f"joint_{k}" for k in range(7, 0, -1))
    joints.write_text(
        f"joints: [{names}]\npoints: [{{time: 1, position: [0, -0.9, -0.4, 1, 0.1, 0.2, 0]}}]\n",
        encoding="utf-8",
    )
    run = robot("posture", "--file", joints, "--tolerance", "10")  # the lowest task of all
    assert run.wait(WAIT) == 0, run.output
    _, sent, reached = words(run.output)
    assert sent == "SENT posture to 0 -0.9 -0.4 1 0.1 0.2 0 over 1 s"
    assert reached.startswith("REACHED posture at 0 0.2 0.1 1 -0.4 -0.9 0, error ")


def test_a_refusal_is_an_error_with_its_reason(robot: Callable[..., Any]) -> None:
    for arguments, reason in {
        ("elbo", *NEAR): "unknown task 'elbo'; known: end_effector, elbow, posture",
        ("elbow", "1", "2"): "task 'elbow': 2 numbers given, 3 expected",
        ("elbow", "500", "0", "300"): "task 'elbow', position: 500 given, at most 10 expected",
    }.items():
        run = robot(*arguments)
        assert run.wait(WAIT) == 1, run.output
        assert words(run.output)[-1].startswith(f"REJECTED {reason}")


def test_what_is_not_reached_in_time_says_how_far_it_is(robot: Callable[..., Any]) -> None:
    assert robot("end_effector", *NEAR).wait(WAIT) == 0  # there is a controller
    run = robot("end_effector", "1.5", "0", "0.7", "--timeout", "8")
    assert run.wait(WAIT) == 1, run.output
    last = run.output.splitlines()[-1]
    assert last.startswith("reference: 'end_effector' did not reach its reference, error ")
    assert last.endswith(" within 8 s")


def test_without_a_controller_one_line_says_so(start_node: Callable[..., Any]) -> None:
    run = start_node("ghc_controller", "reference", "elbow", "0", "0", "0", "--timeout", "0.5")
    assert run.wait(WAIT) == 1
    assert run.output == (
        "reference: no ghc/controller_state: no controller, or one without joint_states, "
        "within 0.5 s\n"
    )


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["elbow"],
        ["elbow", "here"],
        ["elbow", "0.1", "--file", "path.csv"],
        ["elbow", "--file", "path.csv", "--duration", "1"],
        ["elbow", "0.1", "--duration", "-1"],
        ["elbow", "0.1", "--duration", "1", "--velocity", "1"],
        ["elbow", "0.1", "--start", "-1"],
    ],
)
def test_wrong_arguments_are_refused_before_anything_is_sent(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as error:
        main(arguments)
    assert error.value.code == 2
    assert "usage: reference" in capsys.readouterr().err


def test_a_file_that_cannot_be_used_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["elbow", "--file", "no_such.csv"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("reference: no_such.csv: cannot be read")


def test_a_move_is_minimum_jerk_from_the_reference_in_force() -> None:
    robot = load_robot("kuka_lwr")
    task = robot.tasks[0]
    start, end = np.array([0.4, 0.0, 0.5]), np.array([0.5, 0.1, 0.7])
    present = SimpleNamespace(name=task.name, reference=start, error=np.zeros(3))
    points = Move(tuple(end), duration=2.0).points_from(present)
    message = reference_message(task.name, points, 1.0)
    reference: ReferenceTrajectory = reference_from_message(message, task, start, 0.0)
    for time in np.linspace(1.0, 3.0, 21):
        s = (time - 1.0) / 2.0
        share = 10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5
        assert reference.target(time).position == pytest.approx(start + share * (end - start))


def test_orientations_and_poses_take_a_quaternion_of_any_length() -> None:
    orientation = SimpleNamespace(name="o", reference=[0.0, 0.0, 0.0, 1.0], error=[0.0] * 3)
    (_, end) = Move((), (0.0, 0.0, 2.0, 0.0), velocity=1.0).points_from(orientation).points
    assert end.position == (0.0, 0.0, 1.0, 0.0)
    assert end.velocity == (0.0,) * 3
    assert end.time == pytest.approx(1.875 * np.pi)
    pose = SimpleNamespace(name="p", reference=[0.0] * 6 + [1.0], error=[0.0] * 6)
    (_, end) = Move((3.0, 0.0, 4.0), (0.0, 0.0, 0.0, 1.0), velocity=2.0).points_from(pose).points
    assert end.time == pytest.approx(1.875 * 5.0 / 2.0)
    with pytest.raises(ConfigurationError, match="an orientation is --quaternion"):
        Move((3.0, 0.0, 4.0)).points_from(pose)
    with pytest.raises(ConfigurationError, match="0 0 0 0 given"):
        Move((), (0.0,) * 4).points_from(orientation)


def test_references_are_compared_up_to_the_sign_of_a_quaternion() -> None:
    turn = np.array([0.1, 0.2, 0.3, 0.0, 0.6, 0.0, 0.8])
    assert same_target(turn, turn * [1, 1, 1, -1, -1, -1, -1], turns=True)
    assert same_target(turn, turn[::-1], any_order=True)
    assert not same_target(turn, turn + 0.01, turns=True, any_order=True)
    assert not same_target(turn, turn[1:], turns=True, any_order=True)


def test_a_point_is_neither_its_mirror_image_nor_its_axes_exchanged() -> None:
    """A target at once would otherwise be reached before the robot has moved."""
    point = np.array([0.5, 0.1, 0.7])
    assert same_target(point, point)
    assert not same_target(point, -point)
    assert not same_target(point, point[[1, 0, 2]])
