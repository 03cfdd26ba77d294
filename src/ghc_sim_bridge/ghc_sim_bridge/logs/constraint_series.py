"""Bounds and obstacles used by the controller over a run, as arrays and as a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ghc_controller.errors import ConfigurationError
from ghc_controller.types import Array

_CONTACT, _OBSTACLE, _LIMIT = "contact_", "obstacle_", "limit_"
_CONTACT_COLUMNS, _OBSTACLE_COLUMNS, _LIMIT_COLUMNS = 3, 13, 2
LOWER, UPPER, FORCE = range(_CONTACT_COLUMNS)
POSITION, VELOCITY, ACCELERATION, NORMAL = (slice(3 * k, 3 * k + 3) for k in range(4))
SAFE_DISTANCE = 12


@dataclass(frozen=True, slots=True)
class ConstraintSeries:
    """S samples; rows are NaN where the controller had no such bound or obstacle."""

    time: Array  # (S,) [s] simulated
    contacts: Mapping[str, Array]  # name -> (S, 3) lower, upper, commanded force [N]
    obstacles: Mapping[str, Array]  # id -> (S, 13) position [m], velocity, acceleration, normal,
    #                                 safe distance [m]; world axes
    frames: Mapping[str, str]  # id -> protected frame
    # "joint_limits/joint_1" or "torque_limits/.." -> (S, 2) lower, upper [rad] or [Nm]
    limits: Mapping[str, Array] = field(default_factory=dict)

    @property
    def is_empty(self) -> bool:
        """True if the controller had neither bounds nor obstacles."""
        return not (self.contacts or self.obstacles or self.limits)

    def save(self, path: Path) -> None:
        """Write an .npz."""
        arrays: dict[str, Any] = {"time": self.time}
        arrays |= {_CONTACT + name: values for name, values in self.contacts.items()}
        arrays |= {_OBSTACLE + name: values for name, values in self.obstacles.items()}
        arrays |= {_LIMIT + name: values for name, values in self.limits.items()}
        arrays["frames"] = np.array(
            [[name, frame] for name, frame in self.frames.items()], dtype=np.str_
        ).reshape(-1, 2)
        np.savez_compressed(path, **arrays)

    @classmethod
    def load(cls, path: Path) -> ConstraintSeries:
        """Read a file written by `save`. Raises ConfigurationError if it is missing or invalid."""
        try:
            with np.load(path, allow_pickle=False) as data:
                return cls(
                    time=data["time"],
                    contacts=_with_prefix(data, _CONTACT),
                    obstacles=_with_prefix(data, _OBSTACLE),
                    frames={str(name): str(frame) for name, frame in data["frames"]},
                    limits=_with_prefix(data, _LIMIT),
                )
        except (OSError, KeyError, ValueError) as error:
            raise ConfigurationError(f"constraints of a run, '{path}': {error}") from error


class ConstraintTrace:
    """Collects `controller_state` messages into a series."""

    def __init__(self) -> None:
        self._time: list[float] = []
        self._contacts: dict[str, dict[int, list[float]]] = {}  # name -> row -> values
        self._obstacles: dict[str, dict[int, list[float]]] = {}
        self._frames: dict[str, str] = {}
        self._limits: dict[str, dict[int, list[float]]] = {}

    def append(self, time: float, state: Any) -> None:
        """Add one ControllerState at `time` [s], increasing."""
        row = len(self._time)
        self._time.append(time)
        for contact in state.contacts:
            if contact.planned:
                # Planned, but not felt yet: the QP holds its force at 0, whatever the plan allows.
                bounds = [contact.lower, contact.upper] if contact.on else [0.0, 0.0]
                values = [*bounds, contact.force]
                self._contacts.setdefault(contact.name, {})[row] = values
        for entry in state.obstacles:
            self._frames[entry.id] = entry.protected_frame
            self._obstacles.setdefault(entry.id, {})[row] = [
                *entry.position,
                *entry.velocity,
                *entry.acceleration,
                *entry.normal,
                entry.safe_distance,
            ]

        for bound in state.bounds:
            name = f"{bound.kind}/{bound.row}"
            self._limits.setdefault(name, {})[row] = [bound.lower, bound.upper]

    def series(self) -> ConstraintSeries:
        """The collected series."""
        count = len(self._time)
        return ConstraintSeries(
            time=np.array(self._time),
            contacts={n: _filled(r, count, _CONTACT_COLUMNS) for n, r in self._contacts.items()},
            obstacles={
                n: _filled(r, count, _OBSTACLE_COLUMNS) for n, r in self._obstacles.items()
            },
            frames=dict(self._frames),
            limits={n: _filled(r, count, _LIMIT_COLUMNS) for n, r in self._limits.items()},
        )


def _filled(rows: Mapping[int, list[float]], count: int, columns: int) -> Array:
    values = np.full((count, columns), np.nan)
    values[list(rows)] = list(rows.values())
    return values


def _with_prefix(data: Mapping[str, Any], prefix: str) -> dict[str, Array]:
    return {name.removeprefix(prefix): data[name] for name in data if name.startswith(prefix)}
