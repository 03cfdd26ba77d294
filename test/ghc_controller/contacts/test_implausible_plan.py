"""Plans of force bounds stay within what the robot's file allows a contact."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ghc_controller.contacts import BoundsInForce
from ghc_controller.contacts.contact import OnStale
from ghc_controller.errors import InvalidValue
from ghc_controller.previews.preview import CONTACT_FORCES, Preview
from ghc_controller.previews.status import PreviewStatus

MOST = 100.0  # [N] force_upper of the file


def _bounds() -> BoundsInForce:
    contact: Any = SimpleNamespace(
        name="foot", force_lower=0.0, force_upper=MOST, active=True, on_stale=OnStale.HOLD
    )
    return BoundsInForce([contact])


def _plan(lower: float, upper: float) -> Preview:
    values = np.ones((1, 11))
    status = (PreviewStatus.SMOOTHED,)
    return Preview(
        CONTACT_FORCES,
        0.0,
        0.01,
        ("foot",),
        lower * values,
        upper * values,
        (True,),
        status,
        (False,),
        True,
    )


@pytest.mark.parametrize("lower", [MOST + 1.0, 1e6])
def test_a_lower_bound_above_the_file_is_refused_and_the_plan_before_stays(lower: float) -> None:
    bounds = _bounds()
    bounds.follow(_plan(10.0, 50.0), 0.0)
    with pytest.raises(InvalidValue, match=r"contact 'foot': lower bound .* force_upper = 100 N"):
        bounds.follow(_plan(lower, 2.0 * lower), 0.01)
    values = bounds.at(0.02)
    assert (values.lower[0], values.upper[0]) == (10.0, 50.0)


@pytest.mark.parametrize("values", [(np.nan, 2.0), (1.0, np.nan)])
def test_a_bound_that_is_no_number_is_refused(values: tuple[float, float]) -> None:
    with pytest.raises(InvalidValue, match="nan N given, a number expected"):
        _bounds().follow(_plan(*values))


def test_an_upper_bound_above_the_file_is_cut_to_it() -> None:
    bounds = _bounds()
    bounds.follow(_plan(10.0, 1e6), 0.0)
    assert bounds.at(0.02).upper[0] == MOST
    assert bounds.largest_ahead(0, 0.0, 0.1) == MOST
