"""Random contact schedules: overlapping, contradictory, with jumps on and off the grid."""

from __future__ import annotations

import numpy as np

from ghc_controller.types import Array
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule


def random_schedule(
    rng: np.random.Generator, contact: str, start: float, span: float, feasible: bool = True
) -> ContactSchedule:
    """One to six entries within `span` [s] after `start`; half of the times on a 10 ms grid."""
    count = int(rng.integers(1, 7))
    times = start + np.sort(rng.uniform(-0.2 * span, span, count))
    if rng.random() < 0.5:
        times = np.round(times, 2)
    times = np.unique(times)
    lower, upper = np.sort(rng.uniform(0.0, 60.0, (2, len(times))), axis=0)
    lower[rng.random(len(times)) < 0.4] = 0.0
    upper[(rng.random(len(times)) < 0.3) & (lower == 0.0)] = 0.0
    if not feasible:
        swap = rng.random(len(times)) < 0.5
        lower[swap], upper[swap] = upper[swap], lower[swap]
    return ContactSchedule.checked(contact, times, lower, upper)


def raw_at(schedules: list[tuple[float, ContactSchedule]], times: Array) -> Array:
    """(len(times), 2) lower and upper, the newest schedule that has begun deciding."""
    raw = np.empty((len(times), 2))
    for i, time in enumerate(times):
        begun = [s for _, s in schedules if s.times[0] <= time + 1e-8]
        chosen = begun[-1] if begun else schedules[0][1]
        raw[i] = chosen.at(time + 1e-8)
    return raw
