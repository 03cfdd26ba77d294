"""From the plain problems of test/reference to the controller's own type, and small statistics."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import ghc_controller as ghc
from ghc_controller.formulations import AccelerationRows, ContactRows
from ghc_controller.hierarchy import Priorities
from ghc_controller.types import Array, Bounds

_TESTS = str(Path(__file__).resolve().parents[2] / "test")
if _TESTS not in sys.path:
    sys.path.append(_TESTS)  # the reference lives with the tests, away from src/

if TYPE_CHECKING:
    from reference.plain import Plain


def control_problem(plain: Plain) -> ghc.ControlProblem:
    """The same problem with velocity 0 and one task per level, in strict order."""
    sizes = [len(level.target) for level in plain.levels]
    torque = Bounds(plain.torque_lower, plain.torque_upper)
    general, contacts = plain.rows, plain.contacts
    return ghc.ControlProblem(
        np.ascontiguousarray(np.vstack([level.jacobian for level in plain.levels])),
        np.concatenate([level.target for level in plain.levels]),
        np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
        Priorities.of(np.tril(np.ones((len(sizes), len(sizes))), -1)),
        plain.mass,
        plain.bias,
        np.zeros(len(plain.bias)),
        Bounds(plain.lower, plain.upper),
        torque,
        torque,
        rows=None
        if general is None
        else AccelerationRows(
            general.matrix, general.lower, general.upper, _names("row", len(general.lower))
        ),
        contacts=None
        if contacts is None
        else ContactRows(
            contacts.jacobian,
            contacts.drift,
            contacts.force_jacobian,
            contacts.forces.matrix,
            contacts.forces.lower,
            contacts.forces.upper,
            contacts.center,
            contacts.factor,
            _names("force", len(contacts.forces.lower)),
            contacts.bounds,
        ),
        unactuated=plain.unactuated,
    )


def spread(values: Sequence[float] | Array) -> dict[str, float] | None:
    """Median, 95th percentile and maximum; None of nothing."""
    if len(values) == 0:
        return None
    middle, high = np.percentile(values, [50, 95])
    return {"median": rounded(middle), "p95": rounded(high), "max": rounded(np.max(values))}


def rounded(value: float) -> float:
    """Three significant digits: results are committed."""
    return float(f"{value:.3g}")


def cells(figures: dict[str, float] | None) -> str:
    """`median / p95 / max` of spread()."""
    if figures is None:
        return "-"
    return " / ".join(f"{figures[key]:.1e}" for key in ("median", "p95", "max"))


def _names(word: str, count: int) -> tuple[str, ...]:
    return tuple(f"{word}_{index}" for index in range(count))
