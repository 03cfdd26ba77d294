"""The polynomial of least jerk: at rest at both ends, and its derivatives are its own."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.numerics.minimum_jerk import minimum_jerk


def test_it_rests_at_both_ends_and_beyond() -> None:
    for s, share in ((-1.0, 0.0), (0.0, 0.0), (1.0, 1.0), (2.0, 1.0)):
        assert minimum_jerk(s) == pytest.approx((share, 0.0, 0.0), abs=0.0)
    assert minimum_jerk(0.5)[0] == pytest.approx(0.5)


def test_its_derivatives_are_those_of_finite_differences() -> None:
    for s in np.linspace(0.05, 0.95, 10):
        before, at, after = (minimum_jerk(s + step) for step in (-1e-5, 0.0, 1e-5))
        assert (after[0] - before[0]) / 2e-5 == pytest.approx(at[1], abs=1e-8)
        assert (after[1] - before[1]) / 2e-5 == pytest.approx(at[2], abs=1e-8)
