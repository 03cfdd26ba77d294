"""The executable `transition`: a request by hand, and what it prints of the answers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from ghc_msgs.msg import TransitionStatus
from printed import words

from ghc_controller.ros.time import time_from_seconds
from ghc_controller.ros.transition import main, status_line

WAIT = 120.0  # [s] wall


@pytest.fixture
def robot(start_node: Callable[..., Any]) -> Callable[..., Any]:
    """A simulated robot under control; starts `transition` with arguments."""
    patience = ("-p", f"lockstep_timeout:={WAIT}")
    start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", "-p", "scene:=kuka_lwr", *patience)
    hierarchy = ("-p", "hierarchy:='elbow > posture'")
    start_node("ghc_controller", "controller", "--ros-args", "-p", "robot:=kuka_lwr", *hierarchy)
    return lambda *arguments: start_node("ghc_controller", "transition", *arguments)


def test_a_transition_is_followed_to_its_end(robot: Callable[..., Any]) -> None:
    run = robot("end_effector > elbow = posture", "--duration", "0.5", "--profile", "linear")
    assert run.wait(WAIT) == 0, run.output
    in_force, accepted, active, done = words(run.output)
    assert in_force == "current elbow > posture"
    assert accepted.startswith("ACCEPTED end_effector > elbow = posture, from t =")
    assert accepted.endswith("over 0.5 s")
    assert active == "ACTIVE end_effector > elbow = posture"
    assert done == "DONE end_effector > elbow = posture"
    again = robot("end_effector > elbow = posture")
    assert again.wait(WAIT) == 0, "a request for the current target is done at once"
    assert words(again.output)[-1].startswith("DONE")


def test_a_refusal_is_an_error_with_its_reason(robot: Callable[..., Any]) -> None:
    for arguments, reason in {
        ("elbo > posture",): "unknown task 'elbo'; known: end_effector, elbow, posture",
        ("elbow >> posture",): "malformed hierarchy 'elbow >> posture'",
        ("elbow", "--duration", "-1"): "duration = -1.0 s given, a number of at least 0",
    }.items():
        run = robot(*arguments)
        assert run.wait(WAIT) == 1, run.output
        assert words(run.output)[-1].startswith(f"REJECTED {reason}")


def test_without_a_controller_one_line_says_so(start_node: Callable[..., Any]) -> None:
    run = start_node("ghc_controller", "transition", "elbow", "--timeout", "0.5")
    assert run.wait(WAIT) == 1
    assert run.output == (
        "transition: no ghc/priority_matrix: no controller, or one without joint_states, "
        "within 0.5 s\n"
    )


@pytest.mark.parametrize(
    "arguments", [[], ["elbow", "--profile", "square"], ["elbow", "--start", "-1"]]
)
def test_wrong_arguments_are_refused_before_anything_is_sent(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as error:
        main(arguments)
    assert error.value.code == 2
    assert "usage: transition" in capsys.readouterr().err


def test_each_status_is_one_line_with_the_time_of_the_robot() -> None:
    message = TransitionStatus(
        status=TransitionStatus.ACCEPTED, hierarchy="a > b", duration=2.0, reason=""
    )
    message.header.stamp = time_from_seconds(1.25)
    message.start = time_from_seconds(1.5)
    assert status_line(message) == ("t =    1.250 s  ACCEPTED   a > b, from t = 1.500 s over 2 s")
    message.status, message.reason = TransitionStatus.REJECTED, "no such task"
    assert status_line(message) == "t =    1.250 s  REJECTED   no such task"
