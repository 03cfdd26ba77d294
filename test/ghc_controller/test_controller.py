"""The controller as a library: what it hands out stays as it was."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import fields

import numpy as np

from ghc_controller.controller import Controller
from ghc_controller.types import Array, RobotState


def _arrays(value: object) -> list[Array]:
    """All arrays in a problem, its bounds, rows and priorities."""
    if isinstance(value, np.ndarray):
        return [value]
    if isinstance(value, tuple):
        return [array for part in value for array in _arrays(part)]
    if hasattr(value, "__dataclass_fields__"):
        return [array for field in fields(value) for array in _arrays(getattr(value, field.name))]
    return []


def test_a_problem_outlives_the_next_step() -> None:
    """`problem()` gives copies: a step elsewhere changes none of its arrays."""
    controller = Controller.for_robot("kuka_lwr")
    controller.step(RobotState(0.0, np.full(7, 0.4), np.full(7, 0.1)))
    problem = controller.problem()
    before = deepcopy(_arrays(problem))
    assert len(before) > 10
    controller.step(RobotState(1e-3, np.full(7, -0.3), np.full(7, -0.2)))
    after = _arrays(problem)
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(before, after, strict=True))
    moved = _arrays(controller.problem())
    assert not all(np.array_equal(a, b) for a, b in zip(before, moved, strict=True))
