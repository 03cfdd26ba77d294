"""A case of the comparison, run by every method, and its error measure."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from benchmarks.compare.method import METHODS, Method

Result = dict[str, Any]  # JSON values
GROUPS = ("KUKA", "upper body", "fencing", "ten tasks", "standing")


@dataclass(frozen=True, slots=True)
class Case:
    """One case of the comparison.

    `run` measures a method, a quick run is very small; it raises GhcError where the formulation
    rejects the case, and the reason is the result then.
    """

    name: str  # also the name of a folder
    title: str
    group: str  # of GROUPS: one color in the overview
    figure: str  # of the errors by level, on which methods are compared: "end", "mean" or "none"
    run: Callable[[Method, bool], Result]
    methods: Mapping[str, Method] = field(default_factory=lambda: METHODS)
