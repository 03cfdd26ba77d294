"""Lexicographic least squares over linearized levels: eq. 14 and 19 with the rows of 10."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.kinematics.cascade import Cascade
from ghc_controller.kinematics.damped_steps import adaptive_damping_step
from ghc_controller.kinematics.level_rows import LevelRows
from ghc_controller.kinematics.second_order import ExactTerm, SecondOrderTerms
from ghc_controller.kinematics.settings import KinematicSettings
from ghc_controller.kinematics.step_record import StepRecord
from ghc_controller.kinematics.trust_region import TrustRegion
from ghc_controller.types import Array


class HierarchySolver:
    """One step dq per call; keeps the memory of the levels and of the trust region.

    The number of levels stays the same between calls of `reset`.

    Attributes:
        last: StepRecord of the last step, None before the first one.
        augmented: per level, whether the last step used a second-order term.
    """

    def __init__(self, n: int, settings: KinematicSettings | None = None) -> None:
        """For n velocity coordinates."""
        self.settings = settings or KinematicSettings()
        self._n = n
        self.reset()

    def reset(self) -> None:
        """Forget all steps."""
        self._terms = SecondOrderTerms(self.settings)
        self._region = TrustRegion(self._n, self.settings.trust_region, self.settings.adapts)
        self.last: StepRecord | None = None

    @property
    def augmented(self) -> tuple[bool, ...]:
        """See the class."""
        return self._terms.augmented

    def solve(
        self,
        levels: Sequence[LevelRows],
        lower: Array | None = None,
        upper: Array | None = None,
        own: ExactTerm | None = None,
        term: ExactTerm | None = None,
    ) -> Array:
        """Step dq (n,) of these levels, highest first.

        Args:
            lower, upper: (n,) further bounds on the step, such as joint limits; a bound violated
                by dq = 0 is replaced by 0.
            own, term: exact second-order terms, for model `newton`: see SecondOrderTerms.roots.

        Raises:
            InvalidValue: the number of levels changed, or inequalities or bounds with `adls`.
        """
        if self.last is not None and len(self.last.jacobians) != len(levels):
            raise InvalidValue("the number of levels changed: reset the solver before")
        if self.settings.model == "adls":
            if lower is not None or upper is not None or not all(lv.equality for lv in levels):
                raise InvalidValue("model adls knows neither inequalities nor bounds")
            step = adaptive_damping_step(levels, self.settings)
            self.last = None
            return step
        radii = self._region.radii
        low = -radii if lower is None else np.maximum(-radii, np.minimum(lower, 0.0))
        high = radii if upper is None else np.minimum(radii, np.maximum(upper, 0.0))
        roots = self._terms.roots(levels, self.last, own, term)
        cascade = Cascade(self._n, self.settings, low, high)
        for index, (level, root) in enumerate(zip(levels, roots, strict=True)):
            cascade.add(index, level, root)
        self.last = cascade.finish(levels, self.last)
        self._region.observe(self.last.step)
        return self.last.step
