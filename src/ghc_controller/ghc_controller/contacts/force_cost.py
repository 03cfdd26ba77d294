"""The cost on contact forces: what decides among forces that give the same motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ghc_controller.contacts.contact import Contact
from ghc_controller.contacts.kernels import write_force_cost
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.types import Array

_WEIGHT = 1e-4  # [-] on |f|^2, beside the unit weight of task accelerations
_LEAST_LOAD = 2.0  # [N] below it a contact counts as no lighter


class ForceCost:
    """Small forces, each contact used in proportion to what it carries, and force tasks.

    With F = e^T f, the sum of the normal forces of one contact, p = e^T e of its points, and
    u = f - e F / p, what moves its center of pressure and what friction holds, its cost is

        weight (|f|^2 + W |u|^2 / F) + task weight (F - F_ref)^2.

    |f|^2 alone lets a foot that carries a tenth of the weight W give half of the moment: it then
    stands on its edge, with all its friction used, and tips at the least model error. The second
    term leads to like shares u / F at every contact. It is convex; each step takes its expansion
    of second order at the forces f_0 of the step before, with r = u_0 / F_0,

        |u|^2 / F ~ |u - r F|^2 / F_0 + 2 r^T u - |r|^2 F,

    so that over the steps the forces are those of the least cost (Newton's method).
    """

    def __init__(self, contacts: Sequence[Contact], weight_force: float) -> None:
        """Take W [N] of a robot that stands on its contacts; 0 leaves |f|^2 and force tasks."""
        self._contacts = tuple(contacts)
        self._share = _WEIGHT * weight_force
        self._normals = [contact.normal for contact in self._contacts]
        self._none = [np.zeros(contact.forces) for contact in self._contacts]
        self.reset()

    def reset(self) -> None:
        """Forget the forces of the step before."""
        self._last: list[Array | None] = [None] * len(self._contacts)  # f_0; None: not known
        self._before = list(self._last)  # forces of the last step at an earlier time
        self._newest = list(self._last)
        self._time: float | None = None

    def begin(self, time: float) -> None:
        """Expand about the forces of the step before `time` [s], however often it is asked for."""
        if time != self._time:
            self._before, self._time = list(self._newest), time
        self._last = list(self._before)

    def remember(self, place: int, force: Array | None) -> None:
        """Take forces of the contact at `place`, for the next step; None: it is off."""
        self._newest[place] = None if force is None else force.copy()

    def advance(self) -> None:
        """Expand about the forces that were remembered last."""
        self._last = list(self._newest)

    def knows(self, places: NDArray[np.intp]) -> bool:
        """Whether the cost of the contacts at `places` needs no forces, or has those of before."""
        return self._share == 0.0 or all(self._last[place] is not None for place in places)

    def of(
        self, places: NDArray[np.intp], references: ReferenceSchedule, time: float
    ) -> tuple[Array, Array]:
        """Centre (c,) [N] and factor (c, c) of the contacts at `places`, as in ContactRows.

        Args:
            references: of the force tasks, by the name of the contact.
            time: [s].
        """
        c = sum(self._none[place].shape[0] for place in places)
        center, factor = np.zeros(c), np.zeros((c, c))
        begin = 0
        for place in places:
            contact, known = self._contacts[place], self._last[place]
            last = self._none[place] if known is None else known
            weight, force = _force_task(contact, references, time)
            write_force_cost(
                _WEIGHT,
                self._share,
                _LEAST_LOAD,
                weight,
                force,
                self._normals[place],
                last,
                begin,
                center,
                factor,
            )
            begin += last.shape[0]
        return center, factor


def _force_task(
    contact: Contact, references: ReferenceSchedule, time: float
) -> tuple[float, float]:
    """Weight [-] of a contact's force task at `time` [s] and its force [N]; zeros without one."""
    if contact.force_task is None:
        return 0.0, 0.0
    target = references.current(contact.force_task.name, time)
    if target.wrench is None:
        return 0.0, 0.0
    share = min(max(float(target.position[0]), 0.0), 1.0)
    return contact.force_task.weight * share, float(target.wrench[0])
