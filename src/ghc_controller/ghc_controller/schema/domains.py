"""Domains of settings, shared by readers, documentation tables and editor schemas."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ghc_controller.schema.value_checks import is_number, shown


class Domain(ABC):
    """Values of a setting beside its type."""

    @abstractmethod
    def problem(self, value: Any) -> str:
        """What is wrong with a value of the right type; empty if nothing is."""

    @property
    @abstractmethod
    def words(self) -> str:
        """The domain in a table."""

    @abstractmethod
    def schema(self) -> dict[str, Any]:
        """The domain as keywords of JSON Schema."""


@dataclass(frozen=True, slots=True)
class Range(Domain):
    """Finite numbers: at least `minimum`, more than `above`, at most `maximum`."""

    minimum: float = -math.inf
    above: float = -math.inf
    maximum: float = math.inf

    def problem(self, value: Any) -> str:
        """A number is expected; infinities and NaN are none."""
        if is_number(value) and self._holds(value):
            return ""
        finite = "finite " if isinstance(value, float) and not math.isfinite(value) else ""
        return f"a {finite}number{self._limits()} expected, {shown(value)} given"

    @property
    def words(self) -> str:
        """Such as > 0."""
        return self._limits().strip().replace("above", ">").replace(">=", "≥").replace("<=", "≤")

    def schema(self) -> dict[str, Any]:
        """minimum, exclusiveMinimum, maximum."""
        bounds = {
            "minimum": self.minimum,
            "exclusiveMinimum": self.above,
            "maximum": self.maximum,
        }
        return {name: bound for name, bound in bounds.items() if math.isfinite(bound)}

    def _holds(self, value: float) -> bool:
        return self.minimum <= value <= self.maximum and value > self.above

    def _limits(self) -> str:
        closed, opened = math.isfinite(self.minimum), math.isfinite(self.above)
        if math.isfinite(self.maximum) and (closed or opened):
            lowest = f"({self.above:g}" if opened else f"[{self.minimum:g}"
            return f" in {lowest}, {self.maximum:g}]"
        if math.isfinite(self.maximum):
            return f" <= {self.maximum:g}"
        if opened:
            return f" above {self.above:g}"
        return f" >= {self.minimum:g}" if closed else ""


@dataclass(frozen=True, slots=True)
class OneOf(Domain):
    """One of some texts."""

    choices: tuple[str, ...]

    def problem(self, value: Any) -> str:
        """Lists what there is."""
        known = ", ".join(self.choices)
        return "" if value in self.choices else f"'{value}' given; known: {known}"

    @property
    def words(self) -> str:
        """All of them, as code."""
        return ", ".join(f"`{choice}`" for choice in self.choices)

    def schema(self) -> dict[str, Any]:
        """An enumeration."""
        return {"enum": list(self.choices)}


@dataclass(frozen=True, slots=True)
class Distinct(Domain):
    """Texts that differ; out of `choices`, if there are any."""

    choices: tuple[str, ...] = ()

    def problem(self, value: Any) -> str:
        """The first one that is unknown or stands twice."""
        return names_problem(value, self.choices or None)

    @property
    def words(self) -> str:
        """Such as any of `a`, `b`."""
        return "any of " + ", ".join(f"`{c}`" for c in self.choices) if self.choices else ""

    def schema(self) -> dict[str, Any]:
        """Unique items."""
        items = {"items": {"enum": list(self.choices)}} if self.choices else {}
        return {"uniqueItems": True, **items}


@dataclass(frozen=True, slots=True)
class NotEmpty(Domain):
    """A text that has to be given."""

    def problem(self, value: Any) -> str:
        """An empty text is none."""
        return "" if value else f"it is needed, {shown(value)} given"

    @property
    def words(self) -> str:
        """Required."""
        return "required"

    def schema(self) -> dict[str, Any]:
        """At least one character."""
        return {"minLength": 1}


def names_problem(values: Sequence[str], known: Sequence[str] | None) -> str:
    """Of a list of names: one that is not among the known ones, or that stands twice."""
    for name in values:
        if known is not None and name not in known:
            return f"'{name}' given; known: {', '.join(known)}"
    if len(set(values)) != len(values):
        return f"names must differ, {shown(list(values))} given"
    return ""


POSITIVE = Range(above=0.0)
NOT_NEGATIVE = Range(minimum=0.0)
AT_LEAST_ONE = Range(minimum=1.0)
SHARE = Range(minimum=0.0, maximum=1.0)
# Their periods are whole numbers of nanoseconds, more than zero.
RATE = Range(minimum=1e-3, maximum=1e6)  # [Hz] of a topic
PLAN_STEP = Range(minimum=1e-6, maximum=10.0)  # [s] between two plans, and two points of a preview
