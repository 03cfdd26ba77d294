"""References that cannot be meant are rejected, by task and field; wide ones go through."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller import Controller, load_robot
from ghc_controller.errors import InvalidValue
from ghc_controller.references.plausibility import check_plausible
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.types import Array

CONTROLLER = Controller(load_robot("kuka_lwr"))
FAR = np.array([[3.0, -3.0, 1.0]])  # [m] out of reach, as scenarios have it


def _check(task: str, position: Array, **fields: Array) -> None:
    follower = CONTROLLER.references.task(task)
    reference = ReferenceTrajectory.for_task(
        follower, np.arange(float(len(position))), position, **fields
    )
    model = CONTROLLER.model
    check_plausible(follower, reference, model.limits, model.joint_names)


def test_out_of_reach_is_plausible() -> None:
    _check("end_effector", FAR, velocity=np.full((1, 3), 5.0))


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"position": FAR * 1e3}, "position: 3000 given, at most 10"),
        ({"position": FAR, "velocity": FAR * 1e5}, "velocity: 300000 given, at most 10"),
        (
            {"position": FAR, "velocity": FAR, "acceleration": FAR * 1e9},
            r"acceleration: 3e\+09 given",
        ),
        ({"position": FAR, "wrench": FAR * 1e4}, "wrench: 30000 given"),
    ],
)
def test_too_far_too_fast_too_sharp(fields: dict[str, Array], text: str) -> None:
    with pytest.raises(InvalidValue, match=f"task 'end_effector', {text}"):
        _check("end_effector", **fields)


def test_a_posture_outside_the_joint_limits_names_the_joint() -> None:
    posture = np.zeros((2, 7))
    posture[1, 3] = 10.0
    with pytest.raises(InvalidValue, match="position: 10 rad given for 'joint_4', -"):
        _check("posture", posture)
