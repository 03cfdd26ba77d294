"""Configurations inside and outside of the limits of their joints."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import ROBOTS, make_model

from ghc_controller.errors import OutsideLimits
from ghc_controller.model.limit_check import check_limits


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_joint_farthest_outside_is_named(robot: str) -> None:
    model = make_model(robot)
    first = model.nq - model.na
    limits = model.limits
    bounded = np.isfinite(limits.position_lower) & np.isfinite(limits.position_upper)
    middle = 0.5 * (limits.position_lower + limits.position_upper)
    q = np.zeros(model.nq)
    q[first:] = np.where(bounded, middle, 0.0)
    check_limits(model, q)
    one, other = np.flatnonzero(bounded)[:2]
    q[first + one] = limits.position_upper[one] + 0.1
    q[first + other] = limits.position_lower[other] - 0.2
    with pytest.raises(OutsideLimits, match="expected") as raised:
        check_limits(model, q)
    assert raised.value.joint == model.joint_names[other]
    assert raised.value.value == q[first + other]
    assert raised.value.lower == limits.position_lower[other]
    check_limits(model, q, tolerance=0.2001)
    q[first] = np.nan
    with pytest.raises(OutsideLimits, match=model.joint_names[0]):
        check_limits(model, q, tolerance=1.0)
