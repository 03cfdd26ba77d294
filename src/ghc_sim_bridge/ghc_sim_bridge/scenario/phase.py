"""Phases of a scenario: priorities and durations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ghc_controller.errors import InvalidField
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE, SHARE
from ghc_controller.schema.reader import Fields

AS_SCENARIO = -1.0  # [s] marks a missing hold; not valid in a file


@dataclass(frozen=True, slots=True)
class PriorityTable:
    """A priority matrix with the names of its rows and columns."""

    tasks: tuple[str, ...]  # k names
    alpha: tuple[tuple[float, ...], ...]  # (k, k) [-]; alpha[i][j] = 1: j strictly before i


def _read_alpha(fields: Fields, name: str) -> tuple[tuple[float, ...], ...]:
    if not fields.has(name):
        return ()
    size = len(fields.names("tasks", of="task names"))
    rows = fields.value(name)
    if not isinstance(rows, list) or len(rows) != size:
        given = len(rows) if isinstance(rows, list) else repr(rows)
        raise fields.error(name, f"{size} rows (one per task) expected, {given} given")
    alpha = fields.vectors(name, size)
    for k, row in enumerate(alpha):
        if min(row) < 0.0 or max(row) > 1.0:
            raise fields.error(f"{name}[{k}]", f"numbers in [0, 1] expected, {list(row)} given")
    return alpha


@dataclass(frozen=True, slots=True)
class Phase:
    """A hierarchy and how long it is held after its transition."""

    hierarchy: str = declared(
        "such as 'end_effector > elbow'; with alpha the text that is shown", ""
    )
    hold: float = declared(
        "after the transition; left out = of the scenario",
        AS_SCENARIO,
        unit="s",
        domain=NOT_NEGATIVE,
    )
    tasks: tuple[str, ...] = declared("rows and columns of alpha", (), of="task names")
    alpha: tuple[tuple[float, ...], ...] = declared(
        "priority matrix instead of a hierarchy; alpha[i][j] = 1: j strictly before i",
        (),
        unit="-",
        read=_read_alpha,
        schema=lambda schema: schema.rows_of(SHARE),
    )
    paper: Mapping[str, Any] = declared("the paper's figures for this phase", dict)

    def __post_init__(self) -> None:
        """Raise InvalidField for a phase without priorities."""
        if self.tasks and not self.alpha:
            raise InvalidField("alpha", "missing; tasks are given")
        if not self.hierarchy:
            if not self.alpha:
                raise InvalidField("hierarchy", "missing, and no alpha in its place")
            object.__setattr__(self, "hierarchy", f"alpha of {', '.join(self.tasks)}")

    @property
    def table(self) -> PriorityTable | None:
        """The matrix used instead of the hierarchy string."""
        return PriorityTable(self.tasks, self.alpha) if self.alpha else None
