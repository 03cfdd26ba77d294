"""Log of every control period of a run, in memory and as an .npz file, for analysis."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ghc_controller.errors import ConfigurationError
from ghc_controller.types import Array

BLOCK_ROWS = 1 << 10  # allocated in a fraction of a control period; one copy of all would not be
WRENCH_PREFIX = "wrench_"
_VECTORS = ("q", "v", "acceleration", "torque", "commanded")
_BASE = {"base_pose": 7, "base_velocity": 6}


class Source(IntEnum):
    """Origin of the applied torque of a row."""

    COMMAND = 0
    HOLD = 1
    GATED = 2  # a command clipped to the limits


@dataclass(frozen=True, slots=True)
class FullRateLog:
    """Row k: the state at t_k and the torque applied over [t_k, t_k + control_dt)."""

    time: Array  # (T,) [s]
    q: Array  # (T, n) [rad]
    v: Array  # (T, n) [rad/s]
    acceleration: Array  # (T, n) [rad/s^2] at t_k under that torque
    torque: Array  # (T, n) [Nm] applied
    commanded: Array  # (T, n) [Nm]; NaN while holding
    source: NDArray[np.uint8]  # (T,) a Source
    epoch: NDArray[np.uint32]  # (T,) count of resets
    cycle_time: Array  # (T,) [s] wall time since the previous row
    wrenches: Mapping[str, Array]  # name -> (T, 6) [N, Nm] on the robot, world axes
    joint_names: tuple[str, ...]
    control_dt: float  # [s]
    base_pose: Array | None = None  # (T, 7) [m], quaternion xyzw, world; None = fixed base
    base_velocity: Array | None = None  # (T, 6) [m/s], [rad/s] in base axes

    def configuration(self, row: int, joint_names: Sequence[str] | None = None) -> Array:
        """q (nq,) of the robot model at a row: base, if floating, and joints in a given order."""
        return _joined(self.base_pose, self.q, row, self._order(joint_names))

    def velocity(self, row: int, joint_names: Sequence[str] | None = None) -> Array:
        """v (nv,) of the robot model at a row."""
        return _joined(self.base_velocity, self.v, row, self._order(joint_names))

    def _order(self, joint_names: Sequence[str] | None) -> list[int]:
        names = self.joint_names if joint_names is None else joint_names
        return [self.joint_names.index(name) for name in names]

    @classmethod
    def load(cls, path: str | Path) -> FullRateLog:
        """Read a file written by FullRateLogBuffer.save.

        Raises:
            ConfigurationError: the file is missing or invalid.
        """
        try:
            with np.load(path, allow_pickle=False) as data:
                return cls(
                    time=data["time"],
                    **{name: data[name] for name in _VECTORS},
                    source=data["source"],
                    epoch=data["epoch"],
                    cycle_time=data["cycle_time"],
                    wrenches={
                        name.removeprefix(WRENCH_PREFIX): data[name]
                        for name in data.files
                        if name.startswith(WRENCH_PREFIX)
                    },
                    joint_names=tuple(str(name) for name in data["joint_names"]),
                    control_dt=float(data["control_dt"]),
                    **{name: data[name] for name in _BASE if name in data.files},
                )
        except (OSError, KeyError, ValueError) as error:
            raise ConfigurationError(f"full-rate log '{path}': {error}") from error


def _joined(base: Array | None, joints: Array, row: int, order: list[int]) -> Array:
    values = joints[row, order]
    return values if base is None else np.concatenate([base[row], values])


class FullRateLogBuffer:
    """Buffer that grows with the run."""

    def __init__(
        self,
        joint_names: Sequence[str],
        contact_names: Sequence[str],
        control_dt: float,
        floating_base: bool = False,
    ) -> None:
        """Rows of n = len(joint_names), one wrench per name in `contact_names`, and the base."""
        self._joint_names = tuple(joint_names)
        self._contact_names = tuple(contact_names)
        self._control_dt = control_dt
        n = len(self._joint_names)
        self._vectors = [slice(2 + k * n, 2 + (k + 1) * n) for k in range(len(_VECTORS))]
        first = 2 + len(_VECTORS) * n
        self._wrenches = [
            slice(first + 6 * k, first + 6 * (k + 1)) for k in range(len(self._contact_names))
        ]
        width = first + 6 * len(self._contact_names)
        self._base: dict[str, slice] = {}
        if floating_base:
            for name, size in _BASE.items():
                self._base[name] = slice(width, width + size)
                width += size
        self._width = width
        self._blocks: list[tuple[Array, NDArray[np.uint32]]] = []  # rows, and their tags
        self._size = 0
        self._grow()

    def __len__(self) -> int:
        return self._size

    def append(
        self,
        time: float,
        cycle_time: float,
        vectors: Sequence[Array],
        wrenches: Mapping[str, Array],
        source: Source,
        epoch: int,
        base: Sequence[Array] = (),
    ) -> None:
        """Add a row; `vectors` are q, v, acceleration, torque, commanded, each (n,), and `base`
        is pose (7,) and velocity (6,) of a floating base."""
        place_in_block = self._size % BLOCK_ROWS
        if self._size and not place_in_block:
            self._grow()
        rows, tags = self._blocks[-1]
        row = rows[place_in_block]
        row[0] = time
        row[1] = cycle_time
        for place, vector in zip(self._vectors, vectors, strict=True):
            row[place] = vector
        for place, name in zip(self._wrenches, self._contact_names, strict=True):
            row[place] = wrenches[name]
        for place, vector in zip(self._base.values(), base, strict=True):
            row[place] = vector
        tag = tags[place_in_block]
        tag[0] = source
        tag[1] = epoch
        self._size += 1

    def _grow(self) -> None:
        rows = np.empty((BLOCK_ROWS, self._width))
        self._blocks.append((rows, np.empty((BLOCK_ROWS, 2), dtype=np.uint32)))

    def columns(self) -> dict[str, NDArray[np.generic]]:
        """The arrays of the .npz by name."""
        rows = np.concatenate([rows for rows, _ in self._blocks])[: self._size]
        tags = np.concatenate([tags for _, tags in self._blocks])[: self._size]
        arrays: dict[str, NDArray[np.generic]] = {"time": rows[:, 0], "cycle_time": rows[:, 1]}
        arrays |= {
            name: rows[:, place] for name, place in zip(_VECTORS, self._vectors, strict=True)
        }
        arrays |= {
            WRENCH_PREFIX + name: rows[:, place]
            for name, place in zip(self._contact_names, self._wrenches, strict=True)
        }
        arrays |= {name: rows[:, place] for name, place in self._base.items()}
        arrays["source"] = tags[:, 0].astype(np.uint8)
        arrays["epoch"] = tags[:, 1]
        arrays["joint_names"] = np.array(self._joint_names, dtype=np.str_)
        arrays["control_dt"] = np.array(self._control_dt)
        return arrays

    def save(self, path: Path) -> None:
        """Write the .npz atomically: readers see the complete file or none."""
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = path.with_name(f".{path.name}.{os.getpid()}")
        with draft.open("wb") as file:
            # Through a variable: numpy's type hints take keywords for its own options.
            save: Any = np.savez
            save(file, **self.columns())
        draft.replace(path)
