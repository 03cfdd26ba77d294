"""A generator of torque limits: motors that are warm may give less, and lose it at a set rate."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ghc_controller.previews.preview import TORQUE_LIMITS, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import POSITIVE
from ghc_mpc_constraints import Generator, Horizon, Sensor


@dataclass(frozen=True, slots=True)
class DeratingSettings:
    """Settings of the generator."""

    rate: float = declared("at which a limit moves", 20.0, unit="Nm/s", domain=POSITIVE)
    step: float = declared("between ticks", 0.01, unit="s", domain=POSITIVE)
    horizon: float = declared("of a preview", 0.5, unit="s", domain=POSITIVE)
    smoothing: bool = declared("false: raw limits", True)


def read(message: Any, reject: Callable[[str], None]) -> dict[str, float]:
    """Largest torque [Nm] by joint: the efforts of a sensor_msgs/JointState."""
    limits = {}
    for name, effort in zip(message.name, message.effort, strict=True):
        if effort > 0.0:
            limits[name] = float(effort)
        else:
            reject(f"joint '{name}': {effort} Nm given, more than 0 expected")
    return limits


class Derating(Generator):
    """Moves each limit towards the newest one at a rate; a tighter one is late by that."""

    kind = TORQUE_LIMITS
    settings_type = DeratingSettings
    input = Sensor("constraints/derating", "sensor_msgs/JointState", read)

    def __init__(self, settings: DeratingSettings) -> None:
        self.settings = settings
        self.horizon = Horizon.of(settings.step, settings.horizon)
        self.counts: Counter[str] = Counter()
        self._raw: dict[str, float] = {}
        self._limits: dict[str, float] = {}
        self._before: Preview | None = None

    def observe(self, given: dict[str, float], now: float) -> None:
        """Take the newest limits."""
        self._raw |= given

    def tick(self, time: float) -> Preview:
        """From the current limit to the newest one."""
        if self._before is not None:  # a tick may have been missed
            self._limits |= dict(zip(self._before.rows, self._before.at(time)[1], strict=True))
        rows = tuple(sorted(self._raw))
        points = self.horizon.times(0.0)
        upper = np.empty((len(rows), len(points)))
        for i, joint in enumerate(rows):
            start, goal = self._limits.get(joint, self._raw[joint]), self._raw[joint]
            way = self.settings.rate * points if self.settings.smoothing else np.inf
            upper[i] = start + np.clip(goal - start, -way, way)
        count = len(rows)
        status = (PreviewStatus.SMOOTHED,) * count
        on, fine = (True,) * count, (False,) * count
        self._before = Preview(
            *(self.kind, time, self.horizon.step, rows, -upper, upper, on, status, fine, True)
        )
        return self._before

    def take_over(self, in_force: Preview) -> None:
        """Start from the limits in force."""
        for i, joint in enumerate(in_force.rows):
            self._limits.setdefault(joint, float(in_force.upper[i, 0]))

    def reset(self) -> None:
        """Forget all limits."""
        self._raw, self._limits = {}, {}
        self._before = None
