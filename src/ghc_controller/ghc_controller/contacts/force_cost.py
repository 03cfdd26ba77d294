"""The cost on contact forces: selects among forces that give the same motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ghc_controller.contacts.contact import Contact
from ghc_controller.core import force_costs
from ghc_controller.hierarchy.priorities import Candidate
from ghc_controller.problem.control_problem import ForceExpansion
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.types import Array

_WEIGHT = 1e-4  # [-] of |f|^2, relative to the unit weight of task accelerations
_LEAST_LOAD = 2.0  # [N] lower bound of F in the cost

ALL = b""  # in place of a candidate: the answer of all, blended
_Forces = list[Array | None]  # of each contact; None: unknown


class ForceCost:
    """Small forces, load-proportional use of each contact, and force tasks.

    With F = e^T f, the sum of the normal forces of one contact, its number of points p = e^T e,
    and u = f - e F / p, the part that moves the center of pressure and uses friction, its cost is

        weight (|f|^2 + W |u|^2 / F) + task weight (F - F_ref)^2.

    With |f|^2 alone, a foot that carries a tenth of the weight W provides half of the moment: its
    center of pressure is on the edge, its friction is used up, and a small model error tips it.
    The second term equalizes u / F over the contacts. It is convex; each step uses its
    second-order expansion at the forces f_0 of the previous step, with r = u_0 / F_0,

        |u|^2 / F ~ |u - r F|^2 / F_0 + 2 r^T u - |r|^2 F,

    so that the forces converge to the minimum over the steps (Newton's method).

    Each candidate of a mixture of orders has its own f_0, the forces of its own answer: about
    those of the blend, which move with the shares, its answer would move with them. One that
    enters the mixture starts from the blend.

    Attributes:
        keys: of the candidates of this step, if each has its own cost.
    """

    keys: tuple[bytes, ...]

    def __init__(self, contacts: Sequence[Contact], weight_force: float) -> None:
        """W [N] is the robot's weight; with 0 only |f|^2 and force tasks remain."""
        self._contacts = tuple(contacts)
        self._share = _WEIGHT * weight_force
        self._normals = [contact.normal for contact in self._contacts]
        self._none = [np.zeros(contact.forces) for contact in self._contacts]
        self.reset()

    def reset(self) -> None:
        """Discard the forces of the previous step."""
        self.keys = ()
        self._last: dict[bytes, _Forces] = {ALL: [None] * len(self._contacts)}  # f_0
        self._before = _copied(self._last)  # forces of the last step at an earlier time
        self._newest = _copied(self._last)
        self._time: float | None = None

    def begin(self, time: float, candidates: Sequence[Candidate] = ()) -> None:
        """Expand about the forces of the step before `time` [s]; repeated calls change nothing.

        Args:
            candidates: those that are answered each by itself.
        """
        if time != self._time:
            self._before, self._time = _copied(self._newest), time
        self._last, self.keys = _copied(self._before), ()
        if self._share == 0.0:
            return
        if len(candidates) > 1:
            self.keys = tuple([candidate.alpha.tobytes() for candidate in candidates])
        elif candidates and len(self._last) > 1:  # the one that is left of a mixture
            own = self._last.get(candidates[0].alpha.tobytes())
            self._last = {ALL: own or self._last[ALL]}

    def remember(self, place: int, force: Array, candidate: bytes = ALL) -> None:
        """Store forces (f,) [N] of the contact at `place` for the next step."""
        stored = self._newest.setdefault(candidate, [None] * len(self._contacts))
        stored[place] = force.copy()

    def forget(self, place: int) -> None:
        """Discard the forces of the contact at `place`, which is off."""
        for stored in self._newest.values():
            stored[place] = None

    def forget_candidates(self) -> None:
        """Keep the forces of the blend alone for the next step."""
        if len(self._newest) > 1:
            self._newest = {ALL: self._newest[ALL]}

    def advance(self) -> None:
        """Expand about the forces stored last."""
        self._last = _copied(self._newest)

    def knows(self, active: Sequence[bool]) -> bool:
        """Whether the cost of the active contacts needs no previous forces, or has them."""
        if self._share == 0.0:
            return True
        stored = self._last[ALL]
        return all(last is not None for on, last in zip(active, stored, strict=True) if on)

    def entering(self) -> list[int]:
        """Places in `keys` of candidates that were not there in the step before."""
        return [place for place, key in enumerate(self.keys) if key not in self._last]

    def of(
        self,
        places: NDArray[np.intp],
        references: ReferenceSchedule,
        time: float,
        candidate: bytes = ALL,
    ) -> ForceExpansion:
        """Center (c,) [N] and factor (c, c) of the contacts at `places`, as in ContactRows.

        Args:
            references: of the force tasks, by the name of the contact.
            time: [s].
            candidate: one of `keys`; ALL: about the forces of the blend.
        """
        stored = self._last.get(candidate) or self._last[ALL]
        c = sum(self._none[place].shape[0] for place in places)
        center, factor = np.zeros(c), np.zeros((c, c))
        contacts = []
        for place in places:
            known = stored[place]
            last = self._none[place] if known is None else known
            task = _force_task(self._contacts[place], references, time)
            contacts.append((self._normals[place], last, *task))
        force_costs(_WEIGHT, self._share, _LEAST_LOAD, contacts, center, factor)
        return ForceExpansion(center, factor)


def _copied(forces: dict[bytes, _Forces]) -> dict[bytes, _Forces]:
    return {candidate: list(stored) for candidate, stored in forces.items()}


def _force_task(
    contact: Contact, references: ReferenceSchedule, time: float
) -> tuple[float, float]:
    """Weight [-] and force [N] of a contact's force task at `time` [s]; zeros without one."""
    if contact.force_task is None:
        return 0.0, 0.0
    target = references.current(contact.force_task.name, time)
    if target.wrench is None:
        return 0.0, 0.0
    share = min(max(float(target.position[0]), 0.0), 1.0)
    return contact.force_task.weight * share, float(target.wrench[0])
