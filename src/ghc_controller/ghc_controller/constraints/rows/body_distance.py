"""Distances between the bodies of a robot, and to obstacles, that stay above their margins."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from ghc_controller.constraints.bodies.activation import ALWAYS, relaxation
from ghc_controller.constraints.bodies.collection import Body, watched
from ghc_controller.constraints.bodies.fields import BodyDistanceFields, bodies_of_links
from ghc_controller.constraints.bodies.geometry import Motion, Near
from ghc_controller.constraints.bodies.law import Margin, jerks_along, least_acceleration
from ghc_controller.constraints.bodies.left_out import LeftOut
from ghc_controller.constraints.bodies.pairs import Pair, chosen_pairs, without_neighbors
from ghc_controller.constraints.constraint import Constraint, Rows, Softness, Space, Tick
from ghc_controller.constraints.registry import register_constraint
from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.previews.limits_in_force import LimitsInForce, MovingLimits
from ghc_controller.previews.preview import BODY_MARGINS, Preview
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.types import Array

_FARTHEST = 1e3  # [m] upper bound of a margin, which nothing reaches
_NOTHING = 1e3  # [-] relaxation of a row that allows everything


@register_constraint("body_distance")
class BodyDistance(Constraint):
    """d >= margin for pairs of bodies, d the distance of their surfaces.

    Each pair within the influence distance has a row on d'' = J x + drift, by which d can still
    stop before its margin (`bodies/law.py`). Rows are relaxed while they come into the influence
    distance or among the nearest (`activation`), so none appears with a jump.

    Attributes:
        bodies: name -> body, obstacles included.
        margins: their names, the rows of previews.
        least_margins: name -> [m] of robot.yaml, below which no preview lowers it.
        pairs: p pairs of bodies that are looked at.
    """

    entry = BodyDistanceFields
    space = Space.ACCELERATION
    softness = Softness.SOFT
    kind = BODY_MARGINS

    def __init__(
        self,
        name: str,
        model: RobotModel,
        bodies: Mapping[str, Body],
        margins: Mapping[str, tuple[Sequence[Pair], float]],
        excluded: Sequence[Pair] = (),
        brake: float = 5.0,
        influence: float = 0.25,
        most: int = 16,
        moving: Collection[str] = (),
    ) -> None:
        """Bodies by name; margins [m] by name with the patterns of their pairs.

        Args:
            moving: obstacles that move with those of their names, see `follow_obstacles`.

        Raises:
            UnknownName: a pattern that no body matches. InvalidValue: no pair is left.
        """
        super().__init__(name)
        self.bodies = dict(bodies)
        self.brake, self.influence, self.most = brake, influence, most
        names = tuple(bodies)
        fixed = {body for body, given in bodies.items() if not given.frame}
        out = set(chosen_pairs(excluded, names, fixed)) if excluded else set()
        frames = {body: given.frame for body, given in bodies.items() if given.frame}
        self.pairs: list[Pair] = []
        group: list[int] = []
        for number, (patterns, _) in enumerate(margins.values()):
            found = chosen_pairs(patterns, names, fixed)
            found = [pair for pair in found if pair not in out and pair not in self.pairs]
            self.pairs += without_neighbors(found, frames, model)
            group += [number] * (len(self.pairs) - len(group))
        if not self.pairs:
            raise InvalidValue(f"{name}: no pair of bodies is left, at least one expected")
        self.least_margins = {one: float(margin) for one, (_, margin) in margins.items()}
        least = np.array(list(self.least_margins.values()), dtype=np.float64)
        self._group = np.array(group, dtype=np.intp)
        most_of = np.full(len(least), _FARTHEST)
        self.margins = tuple(margins)
        self.limits = LimitsInForce(BODY_MARGINS, tuple(margins), least, most_of, "margin")
        self._watched = watched(model, bodies, self.pairs)
        self._geometry, self._owner = self._watched.geometry, self._watched.owner
        self._names = [f"{name}.{a}-{b}" for a, b in self.pairs]
        self._centers = {one: bodies[one].shapes[0].center for one in moving}
        self._left_out = LeftOut(self.pairs, fixed)
        self.reset()

    @property
    def touching(self) -> tuple[Pair, ...] | None:
        """Pairs without a row, as they overlapped at the first state; None before it."""
        return self._left_out.touching

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> BodyDistance:
        """Build from one entry of `constraints` in robot.yaml."""
        given = read(fields, BodyDistanceFields, names={"frame": model.frame_names})
        twice = sorted(given.bodies.keys() & given.obstacles.keys())
        if twice:
            raise fields.error("obstacles", f"'{twice[0]}' is already taken by a body")
        bodies = {name: Body(one.frame, (one.shape,)) for name, one in given.bodies.items()}
        bodies |= bodies_of_links(given, fields, model)
        bodies |= {name: Body("", (one.shape,)) for name, one in given.obstacles.items()}
        margins = {name: (one.pairs, one.margin) for name, one in given.margins.items()}
        moving = tuple(name for name, one in given.obstacles.items() if one.moves)
        further = (given.excluded, given.brake, given.influence, given.most, moving)
        try:
            return cls(given.name, model, bodies, margins, *further)
        except UnknownName as error:
            raise fields.error("margins", str(error)) from error

    def follow(self, preview: Preview, now: float | None = None) -> tuple[UnknownName, ...]:
        """See `LimitsInForce.follow`; the lower bounds are the margins."""
        return self.limits.follow(preview, now)

    def follow_obstacles(self, plan: Preview) -> None:
        """Move the obstacles that move with those of the same name in a plan of obstacle_motion.

        One that is not in the plan rests where it was last.
        """
        for row, entry in enumerate(plan.motions):
            if entry.id in self._centers:
                self._plans[entry.id] = (plan, row)

    def _place(self, time: float) -> None:
        """Obstacles to where they are at a time [s]."""
        states: dict[int, Array] = {}
        for name, (plan, row) in self._plans.items():
            state = plan.motion_at(row, time) - [self._centers[name], np.zeros(3), np.zeros(3)]
            states |= dict.fromkeys(self._watched.shapes[name], state)
        if states:
            self._watched.geometry.move(states)

    def is_stale(self, time: float) -> bool:
        """Whether the preview has ended at `time` [s]."""
        return self.limits.is_stale(time)

    def reset(self) -> None:
        """Forget the preview, where obstacles are, and which pairs overlapped."""
        self.limits.reset()
        self._plans: dict[str, tuple[Preview, int]] = {}
        self._watched.geometry.rest()
        self._left_out.reset()

    def distances(self) -> Array:
        """(p,) distance [m] of each pair at the state of the last `model.update`."""
        near = self._geometry.near(np.inf)
        found = np.full(len(self.pairs), np.inf)
        np.minimum.at(found, self._owner[near.pairs], near.distance)
        return found

    def pairs_of(self, margin: str) -> tuple[int, ...]:
        """Indices of the pairs with a margin."""
        return tuple(np.flatnonzero(self._group == self.margins.index(margin)).tolist())

    def pair_margins(self, time: float) -> Array:
        """(p,) margin [m] of each pair in force at a time [s]."""
        return np.asarray(self.limits.at(time).lower[self._group])

    def rows(self, tick: Tick) -> Rows | None:
        """A row for each near pair; None without any."""
        self._geometry.model = tick.model  # a copy, where this constraint was made by hand
        time, left_out = tick.state.time, self._left_out
        self._place(time)
        if left_out.touching is None:
            left_out.begin(self._owner[self._geometry.overlapping()].tolist(), self.name)
        margins = self.limits.at(time)
        everything = self._geometry.near(self.influence + float(margins.lower.max()))
        owner = self._owner[everything.pairs]
        room = everything.distance - margins.lower[self._group[owner]]
        left_out.look(owner, room, everything.distance, time)
        if not len(everything.pairs):
            return None
        order = np.argsort(room, kind="stable")
        asked = (room < self.influence) & left_out.watched[owner]
        asked &= ~self._watched.same_as_whole(everything)
        order = order[asked[order]]
        rest = np.inf
        if len(order) > self.most:  # however many are that near: none of them may be left out
            rest = max(float(room[order[self.most]]), ALWAYS * self.influence)
        kept = order[room[order] < rest]
        relaxed = relaxation(room[kept], self.influence, rest)
        relaxed += left_out.relaxation(owner[kept], time)
        kept, relaxed = kept[relaxed < _NOTHING], relaxed[relaxed < _NOTHING]
        if not len(kept):
            return None
        near = everything.only(kept)
        return self._rows(tick, near, self._geometry.motion(near), margins, relaxed)

    def _rows(
        self, tick: Tick, near: Near, motion: Motion, margins: MovingLimits, relaxed: Array
    ) -> Rows:
        owner = self._owner[near.pairs]
        jerk = jerks_along(tick, motion.jacobian)
        lower = np.empty(len(owner))
        for row, group in enumerate(self._group[owner]):
            margin = Margin(
                float(margins.lower[group]),
                float(margins.rates[0, group]),
                float(margins.accelerations[0, group]),
            )
            distance, rate = float(near.distance[row]), float(motion.rate[row])
            least = least_acceleration(distance, rate, margin, self.brake, tick.dt, jerk[row])
            lower[row] = least - self.brake * relaxed[row]
        lower -= motion.drift
        names = tuple(self._names[pair] for pair in owner)
        return Rows(motion.jacobian, lower, np.full(len(owner), np.inf), names)


def margin_names(constraints: Sequence[Constraint]) -> tuple[str, ...]:
    """Names of the margins among some constraints."""
    found = (one.margins for one in constraints if isinstance(one, BodyDistance))
    return tuple(name for names in found for name in names)
