"""Control problems in a file of NumPy arrays, without loss."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import ghc_controller as ghc
from ghc_controller.formulations import AccelerationRows, ContactRows, ForceExpansion
from ghc_controller.hierarchy.priorities import Candidate, Priorities
from ghc_controller.types import Array, Bounds

STATES = Path(__file__).resolve().parent / "states"
_ARRAYS = ("jacobian", "target", "starts", "mass_matrix", "bias", "velocity")
_BOUNDS = ("acceleration", "torque", "torque_limit")
_ROWS = ("matrix", "lower", "upper", "force_matrix")
_CONTACTS = (
    "jacobian",
    "drift_target",
    "force_jacobian",
    "force_matrix",
    "force_lower",
    "force_upper",
    "force_center",
    "force_factor",
)


def save(path: Path, problems: Sequence[ghc.ControlProblem]) -> None:
    """Write problems that were linearized: their second-order terms are left out."""
    arrays = {
        f"{index}/{name}": values
        for index, problem in enumerate(problems)
        for name, values in _arrays(problem).items()
    }
    np.savez_compressed(path, **arrays)  # type: ignore[arg-type]


def load(path: Path) -> list[ghc.ControlProblem]:
    """The problems of a file, in their order; names of rows are numbers."""
    with np.load(path) as file:
        count = 1 + max(int(name.partition("/")[0]) for name in file.files)
        parts: list[dict[str, NDArray[np.float64]]] = [{} for _ in range(count)]
        for name in file.files:
            index, _, rest = name.partition("/")
            parts[int(index)][rest] = file[name]
    return [_problem(part) for part in parts]


def _arrays(problem: ghc.ControlProblem) -> dict[str, Array]:
    arrays = {name: getattr(problem, name) for name in _ARRAYS}
    for name in _BOUNDS:
        bounds = getattr(problem, name)
        arrays |= {f"{name}/lower": bounds.lower, f"{name}/upper": bounds.upper}
    arrays["alpha"] = np.array([candidate.alpha for candidate in problem.priorities.candidates])
    arrays["share"] = np.array([candidate.share for candidate in problem.priorities.candidates])
    rows, contacts = problem.rows, problem.contacts
    arrays["sizes"] = np.array([problem.unactuated, rows.hard if rows else 0, 0])
    if rows is not None:
        found = {name: getattr(rows, name) for name in _ROWS}
        arrays |= {f"rows/{name}": values for name, values in found.items() if values is not None}
    if contacts is not None:
        arrays["sizes"][2] = contacts.bounds
        arrays |= {f"contacts/{name}": getattr(contacts, name) for name in _CONTACTS}
        for index, cost in enumerate(problem.own_costs()):
            place = f"contacts/{index}"
            arrays |= {f"{place}/center": cost.center, f"{place}/factor": cost.factor}
    return arrays


def _problem(arrays: Mapping[str, Array]) -> ghc.ControlProblem:
    def bounds_of(name: str) -> Bounds:
        return Bounds(arrays[f"{name}/lower"], arrays[f"{name}/upper"])

    unactuated, hard, bounds = (int(size) for size in arrays["sizes"])
    rows, contacts = None, None
    if "rows/lower" in arrays:
        names = tuple(map(str, range(len(arrays["rows/lower"]))))
        matrix, lower, upper = (arrays[f"rows/{name}"] for name in _ROWS[:3])
        rows = AccelerationRows(
            matrix, lower, upper, names, arrays.get("rows/force_matrix"), hard=hard
        )
    if "contacts/jacobian" in arrays:
        parts = {name: arrays[f"contacts/{name}"] for name in _CONTACTS}
        names = tuple(map(str, range(len(arrays["contacts/force_lower"]))))
        contacts = ContactRows(**parts, names=names, bounds=bounds)  # type: ignore[arg-type]
        costs = {
            alpha.tobytes(): ForceExpansion(arrays[f"{place}/center"], arrays[f"{place}/factor"])
            for index, alpha in enumerate(arrays["alpha"])
            if f"{(place := f'contacts/{index}')}/center" in arrays
        }
        contacts = contacts._replace(of_candidates=costs)
    mixture = zip(arrays["alpha"], arrays["share"].tolist(), strict=True)
    return ghc.ControlProblem(
        arrays["jacobian"],
        arrays["target"],
        arrays["starts"].astype(np.int64),
        Priorities.mixed([Candidate(np.ascontiguousarray(a), share) for a, share in mixture]),
        arrays["mass_matrix"],
        arrays["bias"],
        arrays["velocity"],
        bounds_of("acceleration"),
        bounds_of("torque"),
        bounds_of("torque_limit"),
        rows=rows,
        contacts=contacts,
        unactuated=unactuated,
    )
