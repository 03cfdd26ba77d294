"""The active contacts as rows of the control problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ghc_controller.constraints.constraint import Rows
from ghc_controller.contacts.contact import STOPPING_RATE, Contact
from ghc_controller.contacts.force_cost import ALL, ForceCost
from ghc_controller.contacts.normal_bounds import NormalBounds
from ghc_controller.contacts.surface import SurfaceContact
from ghc_controller.core import ContactMotion, native
from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy.priorities import Candidate
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.problem.control_problem import ContactRows
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.types import Array

_NONE = np.zeros(0)


class _Part(NamedTuple):
    """One active contact."""

    contact: Contact
    force: slice  # its entries in c
    motion: slice  # its rows in q


@dataclass(frozen=True, slots=True)
class _Layout:
    """Data that is constant for a set of active contacts; q, c and r as in ContactRows."""

    places: NDArray[np.intp]  # of the active contacts
    parts: tuple[_Part, ...]  # the same contacts
    motion: ContactMotion  # of contact kinds compiled in the core
    plugged: tuple[_Part, ...]  # the others
    motion_rows: int  # q
    normals: Array  # (active contacts, c) sums of their normal forces
    normal_names: tuple[str, ...]  # (active contacts,)
    cones: Rows  # (r, c) rows at most 0
    no_rows: Array  # (0, c)
    forces: tuple[tuple[str, slice], ...]  # names of the contacts, and their entries in c


class ContactSet:
    """All contacts of a robot; the set of active ones may change at every tick."""

    def __init__(self, contacts: Sequence[Contact], weight_force: float = 0.0) -> None:
        """Contacts in the order of robot.yaml.

        Args:
            weight_force: [N] weight of a robot that stands on them; 0 for a fixed base.

        Raises:
            InvalidValue: two share a name.
        """
        self.contacts = tuple(contacts)
        self.names = tuple(contact.name for contact in self.contacts)
        for name in self.names:
            if self.names.count(name) > 1:
                raise InvalidValue(f"contact name '{name}' is given twice; names must differ")
        self._cost = ForceCost(self.contacts, weight_force)
        self._layouts: dict[tuple[bool, ...], _Layout] = {}
        self._on: tuple[_Layout, NormalBounds] | None = None

    def rows(
        self,
        model: RobotModel,
        bounds: NormalBounds,
        references: ReferenceSchedule,
        time: float,
    ) -> ContactRows | None:
        """Rows of the active contacts at the last `model.update`; None without any.

        Constraints on the forces are separate: `normal_rows`, `cone_rows`.

        Args:
            references: of the force tasks, by the name of the contact.
            time: [s].
        """
        self._on = None
        if not any(bounds.active):
            return None
        layout = self._layouts.get(bounds.active)
        if layout is None:
            layout = self._layouts[bounds.active] = _layout(self.contacts, bounds.active)
        self._on = layout, bounds
        q, c = layout.motion_rows, layout.normals.shape[1]
        force_jacobian = np.empty((c, model.nv))
        jacobian, drift_target = np.empty((q, model.nv)), np.empty(q)
        layout.motion.write(model.core, jacobian, drift_target, force_jacobian)
        for contact, force, motion in layout.plugged:
            frame = model.frame(contact.frame_id)
            contact.write_forces(frame, force_jacobian[force])
            contact.write_motion(frame, jacobian[motion], drift_target[motion])
        cost, places = self._cost, layout.places
        center, factor = cost.of(places, references, time)
        return ContactRows(
            jacobian,
            drift_target,
            force_jacobian,
            layout.no_rows,
            _NONE,
            _NONE,
            center,
            factor,
            (),
            forces=layout.forces,
            of_candidates={key: cost.of(places, references, time, key) for key in cost.keys},
        )

    @property
    def none_on(self) -> bool:
        """Whether no contact was on at the last `rows`."""
        return self._on is None

    def normal_rows(self) -> Rows | None:
        """Bounds on the normal force of each contact of the last `rows` (thesis, eq. 5.5)."""
        if self._on is None:
            return None
        layout, bounds = self._on
        lower, upper = native.force_limits(bounds.lower, bounds.upper, layout.places)
        return Rows(layout.normals, lower, upper, layout.normal_names)

    def cone_rows(self) -> Rows | None:
        """Friction constraints of each contact of the last `rows` (thesis, eq. 5.3)."""
        return None if self._on is None else self._on[0].cones

    def begin(self, time: float, candidates: Sequence[Candidate] = ()) -> None:
        """Start a step at `time` [s]; repeating a time starts from the same forces.

        Args:
            candidates: those that are answered each by itself; their costs differ (ForceCost).
        """
        self._cost.begin(time, candidates)

    def remember(
        self, active: tuple[bool, ...], force: Array, of_candidates: Sequence[Array] = ()
    ) -> None:
        """Store the forces of the QP and the active contacts for the next step.

        If no QP was solved there are no forces, and those of the previous step are kept.

        Args:
            force: (c,) [N].
            of_candidates: the same of each candidate of `begin`; () where there is one answer.
        """
        layout = self._layouts.get(active)
        if layout is not None and force.shape[0]:
            self._cost.forget_candidates()
            self._store(layout, force)
            keys = self._cost.keys if of_candidates else ()
            for key, own in zip(keys, of_candidates, strict=True):
                self._store(layout, own, key)
        for place, on in enumerate(active):
            if not on:
                self._cost.forget(place)

    def _store(self, layout: _Layout, force: Array, candidate: bytes = ALL) -> None:
        for place, part in zip(layout.places, layout.parts, strict=True):
            self._cost.remember(int(place), force[part.force], candidate)

    def knows_forces(self, active: tuple[bool, ...]) -> bool:
        """False if the cost needs the forces of an active contact and has none yet."""
        return self._cost.knows(active)

    def entering(self) -> list[int]:
        """Candidates of `begin` that have no forces of their own yet, if each has its own cost."""
        return self._cost.entering()

    def advance(self) -> None:
        """Expand the cost of the next rows about the stored forces, at the same time."""
        self._cost.advance()

    def reset(self) -> None:
        """Discard the forces of the previous step."""
        self._cost.reset()

    def normal_forces(self, active: tuple[bool, ...], force: Array) -> Array:
        """Normal force [N] of every contact, zero if inactive, from QP forces (c,)."""
        normal = np.zeros(len(self.contacts))
        layout = self._layouts.get(active)
        if layout is not None and force.shape[0]:
            normal[layout.places] = layout.normals @ force
        return normal

    def friction_use(self, active: tuple[bool, ...], force: Array) -> Array:
        """Largest |F_t| / (mu F_n) [-] over the points of every contact, from QP forces (c,).

        0 for contacts that are inactive, have no friction, or carry almost no force.
        """
        use = np.zeros(len(self.contacts))
        layout = self._layouts.get(active)
        if layout is None or not force.shape[0]:
            return use
        for place, part in zip(layout.places, layout.parts, strict=True):
            use[place] = part.contact.friction_use(force[part.force])
        return use


def _layout(contacts: tuple[Contact, ...], active: tuple[bool, ...]) -> _Layout:
    places = np.flatnonzero(active)
    parts, names = [], []
    q = c = 0
    for place in places:
        contact = contacts[place]
        force = slice(c, c + contact.forces)
        motion = slice(q, q + contact.motion_rows)
        parts.append(_Part(contact, force, motion))
        names.append(f"contact.{contact.name}")
        q, c = motion.stop, force.stop
    normals = np.zeros((len(places), c))
    cones: list[Array] = []
    cone_names: list[str] = []
    for k, (contact, force, _) in enumerate(parts):
        normals[k, force] = contact.normal
        cone = contact.cone()
        rows = np.zeros((cone.shape[0], c))
        rows[:, force] = cone
        cones.append(rows)
        cone_names += [f"contact.{contact.name}.friction"] * cone.shape[0]
    r, cone_matrix = len(cone_names), np.vstack(cones)
    for matrix in (normals, cone_matrix):
        matrix.flags.writeable = False  # see Rows
    return _Layout(
        places,
        tuple(parts),
        *_moved(parts),
        q,
        normals,
        tuple(names),
        Rows(cone_matrix, np.full(r, -np.inf), np.zeros(r), tuple(cone_names)),
        np.zeros((0, c)),
        tuple((part.contact.name, part.force) for part in parts),
    )


def _moved(parts: Sequence[_Part]) -> tuple[ContactMotion, tuple[_Part, ...]]:
    """Splits the contacts into those whose rows the core computes, and others."""
    core, plugged = ContactMotion(STOPPING_RATE), []
    for part in parts:
        contact, kind = part.contact, type(part.contact)
        whole = kind.write_motion is SurfaceContact.write_motion
        known = whole or kind.write_motion is Contact.write_motion
        if known and kind.write_forces is Contact.write_forces:
            core.add(
                contact.frame_id,
                contact.points,
                contact.force_axes,
                whole,
                part.force.start,
                part.motion.start,
            )
        else:
            plugged.append(part)
    return core, tuple(plugged)
