"""The posture nearest to the targets: hierarchical least squares, also from other postures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ghc_controller.kinematics import HierarchySolver, KinematicSettings, Level
from ghc_controller.reachable.held_base import HeldBase
from ghc_controller.reachable.settings import ReachableSettings
from ghc_controller.types import Array

_MET = 3e-4  # [m], [rad] a level that is nearer needs no search
_BETTER = 5e-4  # [m], [rad] by which another posture has to be nearer
_STILL = 1e-5  # [m], [rad], [rad] change per iteration of targets and posture at rest
_PATIENCE = 10  # plans at rest before a search
_LONGEST = 200  # iterations from one posture
_SPREAD = 1.0  # [rad], [m] of the postures tried, about the present one
_SEED = 1
_WIDER = 5.0  # [-] trust region of the search
_SWITCH = 1e-8  # [-] a level within 0.14 mm has no second-order term


class PostureGoal:
    """Gauss-Newton with quasi-Newton at singularities (GN-QN), some iterations per plan.

    The trust region keeps its radius: adapted, it would shrink where a joint's step changes sign,
    which near a target that is followed happens at every rounding, and other joints would move.

    The solver finds a local optimum. Where targets stand still and are not met, it also starts
    from other postures, drawn with a fixed seed, and switches to a better one. Only joints that
    have moved a targeted task take part in that.

    Attributes:
        q: (n,) posture.
        moved_over: the last `advance` went over to another posture.
    """

    def __init__(
        self,
        robot: HeldBase,
        levels: Sequence[Level],
        lower: Array,
        upper: Array,
        q: Array,
        settings: ReachableSettings,
    ) -> None:
        """Between positions lower and upper (n,), from q (n,) on."""
        self._robot, self._levels, self._settings = robot, tuple(levels), settings
        self._lower, self._upper = lower, upper
        self.q, self.moved_over = q.copy(), False
        self._solver, self._other = (
            HierarchySolver(
                robot.n, KinematicSettings(trust_region=radius, switch=_SWITCH, adapts=False)
            )
            for radius in (settings.trust_region, _WIDER * settings.trust_region)
        )
        self._targets: dict[str, Array] = {}
        self._moves = np.zeros(robot.n, dtype=bool)  # joints on the chains of the tasks
        self._begin_search()

    def advance(self, targets: Mapping[str, Array]) -> None:
        """Iterate towards reference positions by task."""
        before = self.q
        for _ in range(self._settings.iterations):
            self.q, self.errors = self._step(self._solver, self.q, targets)
        self.moved_over = False
        if self._has_moved(targets, before):
            self._targets = {name: value.copy() for name, value in targets.items()}
            self._begin_search()
        elif max(self.errors) > _MET:
            self._calm += 1
            if self._calm > _PATIENCE and self._tried < self._settings.restarts:
                self._search(targets)

    def _has_moved(self, targets: Mapping[str, Array], before: Array) -> bool:
        if not self._targets or np.abs(self.q - before).max() > 10.0 * _STILL:
            return True
        return any(np.abs(targets[n] - v).max() > 100.0 * _STILL for n, v in self._targets.items())

    def _begin_search(self) -> None:
        self._random = np.random.default_rng(_SEED)
        self._calm = self._tried = 0
        self._candidate: Array | None = None

    def _search(self, targets: Mapping[str, Array]) -> None:
        """Some iterations from another posture; its end is compared."""
        if self._candidate is None:
            self._candidate = self._other_posture()
            self._other.reset()
            self._iterations = 0
        step = np.inf
        for _ in range(self._settings.iterations):
            before = self._candidate
            self._candidate, errors = self._step(self._other, before, targets)
            step = float(np.abs(self._candidate - before).max())
        self._iterations += self._settings.iterations
        if step < 1e-6 or self._iterations >= _LONGEST:
            if self._is_better(errors):
                self.q, self.moved_over = self._candidate, True
                self._solver.reset()
            self._candidate = None
            self._tried += 1

    def _other_posture(self) -> Array:
        """Near the present one and anywhere in turn."""
        if self._tried % 2:
            lower = np.where(np.isfinite(self._lower), self._lower, self.q - np.pi)
            found = self._random.uniform(
                lower, np.where(np.isfinite(self._upper), self._upper, lower + 2.0 * np.pi)
            )
        else:
            shift = self._random.normal(0.0, _SPREAD, len(self.q))
            found = np.clip(self.q + shift, self._lower, self._upper)
        return np.where(self._moves, found, self.q)

    def _is_better(self, errors: tuple[float, ...]) -> bool:
        for new, old in zip(errors, self.errors, strict=True):
            if abs(new - old) > _BETTER:
                return new < old
        return False

    def _step(
        self, solver: HierarchySolver, q: Array, targets: Mapping[str, Array]
    ) -> tuple[Array, tuple[float, ...]]:
        """q (n,) after an iteration, and the norms of the errors before it, by level."""
        robot = self._robot
        robot.update(q)
        found = [level.rows(robot.model, targets) for level in self._levels]
        rows = [replace(level, jacobian=robot.columns(level.jacobian)) for level in found]
        for level in rows:
            self._moves |= level.chain > 0.0
        step = solver.solve(rows, self._lower - q, self._upper - q)
        errors = tuple(float(np.linalg.norm(level.lower)) for level in rows)
        return np.clip(q + step, self._lower, self._upper), errors
