"""Manipulability: value, gradient and drift against finite differences, and a closed loop."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from model_states import ROBOTS, make_model, moved, random_state

from ghc_controller.errors import InvalidValue
from ghc_controller.tasks.frame import POSE_ROWS
from ghc_controller.tasks.python.manipulability import ManipulabilityTask
from ghc_controller.types import Array

STEP = 1e-4  # [s] of finite differences
AXES = (("x", "y", "z"), ("x", "y"), ("rx", "ry", "rz"), POSE_ROWS)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("axes", AXES)
def test_gradient_and_drift_are_the_second_derivative(axes: tuple[str, ...], robot: str) -> None:
    """m(q(t)) along q' = v + x t: central differences in t; scaled by m."""
    rng = np.random.default_rng(11)
    model = make_model(robot)
    frame = model.frame_names[-1]
    if len(axes) > model.na:
        with pytest.raises(InvalidValue, match=f"{len(axes)} axes given"):
            ManipulabilityTask("m", model, frame, 1.0, 1.0, axes)
        return
    task = ManipulabilityTask("m", model, frame, 1.0, 1.0, axes)

    def value(q: Array) -> float:
        model.update(q, np.zeros(model.nv))
        return float(task.current(model)[0])

    for _ in range(3):
        state, x = random_state(robot, rng), rng.normal(size=model.nv)
        values = [
            value(moved(robot, state.q, state.v * t + 0.5 * x * t * t)) for t in (-STEP, 0.0, STEP)
        ]
        if values[1] < 1e-6:  # the chain to this frame is too short for these rows
            continue
        model.update(state.q, state.v)
        rows = task.measured(model, task.default_target(model))
        scale = values[1]
        slope = (values[2] - values[0]) / (2.0 * STEP)
        assert rows.jacobian[0] @ state.v / scale == pytest.approx(slope / scale, abs=1e-5)
        second = (values[2] - 2.0 * values[1] + values[0]) / STEP**2
        given = rows.jacobian[0] @ x + rows.drift[0]
        assert given / scale == pytest.approx(second / scale, abs=1e-4, rel=1e-4)


def test_an_unreachable_reference_leads_away_from_a_singularity() -> None:
    """Gradient steps from a nearly stretched arm: m rises to a rest of the gradient."""
    model = make_model("kuka_lwr")
    task = ManipulabilityTask("m", model, model.frame_names[-1], 1.0, 1.0)
    q = np.array([0.1, 0.3, -0.2, 0.05, 0.1, 0.05, 0.0])
    found = []
    for _ in range(400):
        model.update(q, np.zeros(model.nv))
        rows = task.measured(model, task.static_target(np.array([1.0])))
        found.append(float(task.current(model)[0]))
        q = q + 0.5 * rows.jacobian[0]
    assert found[0] < 0.02
    assert found[-1] > 5.0 * found[0]
    assert all(after > before - 1e-12 for before, after in pairwise(found))
