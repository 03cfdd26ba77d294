"""`cascade` against each other method in a case: accuracy level by level, and QPs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from benchmarks.compare.case import Case

RATIO, LEAST = 1.05, 1e-5  # an error is larger when it is beyond RATIO times the other + LEAST
_QPS = 1e-3  # per step


class Loss(NamedTuple):
    """A task of which the reference keeps a larger error than another method."""

    phase: int  # from 1
    level: int
    task: str
    error: float  # of the reference [m], [rad] or a share
    other: float
    given_up: bool  # the other one has a larger error at a level above


class Assessment(NamedTuple):
    """How the reference compares with one method in one case."""

    losses: tuple[Loss, ...]
    more_qps: bool
    qps: float  # per step, of the reference
    other_qps: float

    @property
    def plain(self) -> tuple[Loss, ...]:
        """Losses where the other method keeps all levels above at least as well."""
        return tuple(loss for loss in self.losses if not loss.given_up)


Results = Mapping[str, Any]  # of one method in one case


def judge(case: Case, reference: Results, other: Results) -> Assessment | None:
    """Assessment of a case; None where one of them rejects it, or where the other one stops.

    Errors are compared within a phase from the first level on: `end` or `mean`, as the case says.
    """
    if (
        case.figure == "none"
        or "rejected" in reference
        or "rejected" in other
        or other.get("stopped_s") is not None
    ):
        return None
    losses = tuple(_losses(case.figure, reference["phases"], other["phases"]))
    return Assessment(
        losses,
        reference["qps"] > other["qps"] + _QPS,
        reference["qps"],
        other["qps"],
    )


def _losses(figure: str, reference: list[Any], other: list[Any]) -> Iterator[Loss]:
    for number, (mine, theirs) in enumerate(zip(reference, other, strict=False), start=1):
        above = False  # the other one has lost a level above
        level, lost = 0, False
        for one, another in zip(mine["tasks"], theirs["tasks"], strict=True):
            if one["level"] != level:
                above, level, lost = above or lost, one["level"], False
            a, b = one[figure], another[figure]
            if _larger(a, b):
                yield Loss(number, level, one["task"], a, b, above)
            lost = lost or _larger(b, a)


def _larger(a: float, b: float) -> bool:
    return a > RATIO * b + LEAST
