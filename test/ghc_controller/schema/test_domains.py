"""Ranges of numbers: readers, tables and editors agree."""

from __future__ import annotations

import math

import numpy as np
import pytest
from reference.json_schema import problems

from ghc_controller.schema.domains import Range

RANGES = [
    (Range(), "", ""),
    (Range(minimum=-1.0), " >= -1", "≥ -1"),
    (Range(above=0.0), " above 0", "> 0"),
    (Range(maximum=2.0), " <= 2", "≤ 2"),
    (Range(minimum=0.0, maximum=1.0), " in [0, 1]", "in [0, 1]"),
    (Range(above=0.0, maximum=1.0), " in (0, 1]", "in (0, 1]"),
]


@pytest.mark.parametrize(("domain", "limits", "words"), RANGES)
def test_readers_and_editors_accept_the_same_numbers(
    domain: Range, limits: str, words: str
) -> None:
    """On both ends and 200 numbers around them. Seed 7."""
    values = [-1.0, 0.0, 1.0, 2.0, *np.random.default_rng(7).uniform(-3.0, 3.0, 200).tolist()]
    for value in values:
        assert bool(domain.problem(value)) == bool(problems(value, domain.schema(), {}))
    assert domain.words == words
    assert domain.problem("x") == f"a number{limits} expected, 'x' given"


@pytest.mark.parametrize(("domain", "limits", "words"), RANGES)
def test_only_finite_numbers_are_numbers(domain: Range, limits: str, words: str) -> None:
    for value in (math.nan, math.inf, -math.inf):
        assert domain.problem(value).startswith(f"a finite number{limits} expected")
    for other in (True, None, "1", [1.0]):
        assert domain.problem(other).startswith(f"a number{limits} expected")
