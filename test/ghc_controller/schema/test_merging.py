"""Merged settings: deep in mappings, whole in lists, null takes away, arguments stay."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
import pytest

from ghc_controller.schema.merging import merged


@pytest.mark.parametrize(
    ("base", "changes", "expected"),
    [
        ({"a": {"x": 1, "y": 2}}, {"a": {"y": 3}}, {"a": {"x": 1, "y": 3}}),
        ({"a": [1, 2]}, {"a": [3]}, {"a": [3]}),
        ({"a": {"x": 1}, "b": 2}, {"a": None}, {"b": 2}),
        ({"a": {"x": 1, "y": 2}}, {"a": {"x": None}}, {"a": {"y": 2}}),
        ({"a": {"x": 1}}, {"a": {}}, {"a": {"x": 1}}),
        ({"a": 1}, {"a": {"x": None, "y": 2}}, {"a": {"y": 2}}),
        ({"a": {"x": 1}}, {"a": 2}, {"a": 2}),
        ({}, {"a": None}, {}),
    ],
)
def test_what_becomes_of_a_change(base: Any, changes: Any, expected: Any) -> None:
    before = deepcopy((base, changes))
    assert merged(base, changes) == expected
    assert (base, changes) == before


def test_changes_one_after_the_other_are_their_merge() -> None:
    """merged(merged(a, b), c) = merged(a, merged(b, c)) for changes that take nothing away."""
    rng = np.random.default_rng(7)

    def tree(depth: int) -> dict[str, Any]:
        keys = rng.choice(list("abcd"), size=rng.integers(1, 4), replace=False)
        return {
            str(key): tree(depth - 1) if depth and rng.random() < 0.6 else int(rng.integers(9))
            for key in keys
        }

    for _ in range(200):
        base, first, second = tree(3), tree(3), tree(3)
        once = merged(merged(base, first), second)
        # Where `first` puts a number in place of a mapping, its merge with `second` knows no more.
        if all(_same_kinds(x, y) for x, y in ((base, first), (first, second), (base, second))):
            assert once == merged(base, merged(first, second))
        assert merged(once, second) == once


def _same_kinds(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Whether common keys are mappings in both, at any depth, or in neither."""
    return all(
        isinstance(one[key], dict) == isinstance(other[key], dict)
        and (not isinstance(one[key], dict) or _same_kinds(one[key], other[key]))
        for key in set(one) & set(other)
    )
