"""Second-order terms of the levels: when they apply, and when their memory is reset.

Algorithm 1 with the corrections of docs/gn_qn.md: B approximates S alone (structured secant).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.kinematics.level_kernels import positive_root, structured_update
from ghc_controller.kinematics.level_rows import LevelRows
from ghc_controller.kinematics.settings import SECOND_ORDER, KinematicSettings
from ghc_controller.kinematics.step_record import StepRecord
from ghc_controller.types import Array

ExactTerm = Callable[[int, Array], Array]  # (level, weights (m,)) -> (n, n)

_LEAST_CURVATURE = 1e-12  # xi


class SecondOrderTerms:
    """R_l with R_l^T R_l = B_l for every level, from one step to the next.

    A level is augmented while 1/2 |w|^2 of its last step is above `switch`; an equality level
    also in the first step. B of a level and of all below it starts anew when the level switches
    or its active set changes (sections III-C, IV).
    """

    def __init__(self, settings: KinematicSettings) -> None:
        self._settings = settings
        self._B: list[Array] = []
        self.augmented: tuple[bool, ...] = ()

    def roots(
        self,
        levels: Sequence[LevelRows],
        last: StepRecord | None,
        own: ExactTerm | None,
        term: ExactTerm | None,
    ) -> list[Array | None]:
        """R_l (k, n) of every level, None where it is not augmented.

        Args:
            last: record of the previous step; None in the first step.
            own, term: of model `newton`: S of 1/2 |e|^2 for the error of a level, and
                sum_r weights_r grad^2 f_r of a level.
        """
        model = self._settings.model
        if model not in SECOND_ORDER:
            self.augmented = (False,) * len(levels)
            return [None] * len(levels)
        augmented = tuple(self._applies(level, index, last) for index, level in enumerate(levels))
        first = self._first_change(augmented, last)
        self.augmented = augmented
        roots: list[Array | None] = []
        for index in range(len(levels)):
            if model != "newton" and (index >= first or model == "lm"):
                self._start(index, levels, last)
            if not augmented[index]:
                roots.append(None)
                continue
            if model == "newton":
                if own is None or term is None:
                    raise InvalidValue("model newton needs the exact terms of the levels")
                S = self._exact(index, levels, last, own, term)
            else:
                if model == "gn_qn" and last is not None:
                    y = self._gradient_change(index, levels, last)
                    structured_update(self._B[index], y, last.step, _LEAST_CURVATURE)
                S = self._B[index]
            roots.append(positive_root(S))
        return roots

    def _applies(self, level: LevelRows, index: int, last: StepRecord | None) -> bool:
        if last is None:
            return level.equality
        w = last.residuals[index]
        return bool(0.5 * (w @ w) > self._settings.switch)

    def _first_change(self, augmented: tuple[bool, ...], last: StepRecord | None) -> int:
        """First level whose memory is reset, with all levels below; their number if none."""
        if last is None or len(self.augmented) != len(augmented):
            return 0
        for index, (now, before) in enumerate(zip(augmented, self.augmented, strict=True)):
            if now != before or last.active_changed[index]:
                return index
        return len(augmented)

    def _start(self, index: int, levels: Sequence[LevelRows], last: StepRecord | None) -> None:
        """Eq. 18, 20 without J^T J: sum over active levels of max(mu, 1/2 |e_i|^2) I*_i."""
        diagonal = np.zeros(levels[0].jacobian.shape[1])
        for i, level in enumerate(levels[: index + 1]):
            if level.equality or (last is not None and last.active[i].any()):
                e = level.violation
                diagonal += max(self._settings.least_damping, 0.5 * float(e @ e)) * level.chain
        if len(self._B) <= index:
            self._B.append(np.diag(diagonal))
        else:
            self._B[index] = np.diag(diagonal)

    def _gradient_change(self, index: int, levels: Sequence[LevelRows], last: StepRecord) -> Array:
        """y = sum over levels up to this one of (J_i - previous J_i)^T lambda_i, (n,)."""
        y = np.zeros(len(last.step))
        for i in range(index + 1):
            weights = last.multipliers.get((i, index))
            if weights is not None:
                y += weights @ (levels[i].jacobian - last.jacobians[i])
        return y

    def _exact(
        self,
        index: int,
        levels: Sequence[LevelRows],
        last: StepRecord | None,
        own: ExactTerm,
        term: ExactTerm,
    ) -> Array:
        """S_l = -sum_r e_r grad^2 f_r + sum over levels above of their multipliers' terms."""
        S = own(index, levels[index].violation)
        if last is not None:
            for i in range(index):
                weights = last.multipliers.get((i, index))
                if weights is not None:
                    S = S + term(i, weights)
        return S
