"""One case as a file: robot, tasks, goals, limits and states; read by all sides with NumPy."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DT = 1e-3  # [s] control period
WEIGHT_STEP = 100.0  # [-] between the weights of two levels, for the sides that have no levels


@dataclass(frozen=True, slots=True)
class PeerTask:
    """One task; the order of tasks is their strict order."""

    name: str
    kind: str  # position, orientation, center_of_mass or posture
    frame: str  # "" where the kind has none
    stiffness: float  # [1/s^2]
    damping: float  # [1/s]


@dataclass(frozen=True, slots=True)
class PeerContact:
    """A sole on the ground; normal along z of the world."""

    name: str
    frame: str
    points: tuple[tuple[float, float, float], ...]  # [m] in the frame
    friction: float  # [-]
    force_upper: float  # [N]


@dataclass(frozen=True, slots=True, eq=False)
class PeerProblem:
    """States of a closed loop on its way to goals; T states in S segments, n velocities."""

    name: str
    robot: str
    joints: tuple[str, ...]  # (a,) order of q and v behind the base
    floating: bool
    tasks: tuple[PeerTask, ...]
    contacts: tuple[PeerContact, ...]
    q: Array  # (T, nq) base position and quaternion xyzw first, where it floats
    v: Array  # (T, n)
    segment: NDArray[np.int64]  # (T,)
    goals: Mapping[str, Array]  # task -> (S, 3), (S, 4) quaternion xyzw or (S, a) posture
    torque_limit: Array  # (a,) [Nm] symmetric
    velocity_limit: Array  # (a,) [rad/s]
    position_lower: Array  # (a,) [rad]
    position_upper: Array  # (a,) [rad]
    bounded: bool  # whether the torque limits were chosen to be reached

    def begins(self, row: int) -> bool:
        """Whether a segment begins with a state."""
        return row == 0 or bool(self.segment[row] != self.segment[row - 1])

    def weight(self, index: int) -> float:
        """Weight [-] of a task where there are no levels; the last one has 1."""
        return float(WEIGHT_STEP ** (len(self.tasks) - 1 - index))

    def save(self, path: Path) -> None:
        """Write one compressed .npz."""
        path.parent.mkdir(parents=True, exist_ok=True)
        facts: dict[str, Any] = {
            "name": self.name,
            "robot": self.robot,
            "joints": self.joints,
            "floating": self.floating,
            "tasks": [asdict(task) for task in self.tasks],
            "contacts": [asdict(contact) for contact in self.contacts],
            "bounded": self.bounded,
        }
        np.savez_compressed(
            path,
            allow_pickle=False,
            facts=json.dumps(facts),
            **{name: getattr(self, name) for name in _ARRAYS},
            **{f"goal_{name}": value for name, value in self.goals.items()},
        )

    @classmethod
    def load(cls, path: Path) -> PeerProblem:
        """Read a file that `save` wrote."""
        with np.load(path) as data:
            facts = json.loads(str(data["facts"]))
            facts["joints"] = tuple(facts["joints"])
            facts["tasks"] = tuple(PeerTask(**task) for task in facts["tasks"])
            facts["contacts"] = tuple(
                PeerContact(**{**entry, "points": tuple(map(tuple, entry["points"]))})
                for entry in facts["contacts"]
            )
            goals = {task.name: data[f"goal_{task.name}"] for task in facts["tasks"]}
            return cls(**facts, goals=goals, **{name: data[name] for name in _ARRAYS})


_ARRAYS = (
    "q",
    "v",
    "segment",
    "torque_limit",
    "velocity_limit",
    "position_lower",
    "position_upper",
)
