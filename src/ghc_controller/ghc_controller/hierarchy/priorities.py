"""Current priorities: the matrix, and the mixture of accepted targets that it is made of."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ghc_controller.types import Array


class Candidate(NamedTuple):
    """One accepted target and its share of the mixture."""

    alpha: Array  # (k, k)
    share: float  # [-] rho in [0, 1]; the shares of a mixture add up to 1


@dataclass(frozen=True, slots=True, eq=False)
class Priorities:
    """alpha = sum_c rho_c alpha_c over the targets that were accepted (design, section 3.2).

    A ramp starts from the current matrix, so this holds exactly at any time. Formulations with
    projectors read `alpha`; formulations for strict orders solve each candidate and blend the
    solutions.
    """

    alpha: Array  # (k, k)
    candidates: tuple[Candidate, ...]  # c >= 1

    @classmethod
    def of(cls, alpha: Array) -> Priorities:
        """Priorities of a single matrix (k, k)."""
        return cls.mixed((Candidate(alpha, 1.0),))

    @classmethod
    def mixed(cls, candidates: Iterable[Candidate]) -> Priorities:
        """Priorities of a mixture."""
        mixture = tuple(candidates)
        if len(mixture) == 1:
            return cls(mixture[0].alpha, mixture)
        return cls(sum_of(mixture), mixture)


def sum_of(candidates: Sequence[Candidate]) -> Array:
    """(k, k) matrix of a mixture; entries that all candidates share are unchanged."""
    last = candidates[-1].alpha
    alpha: Array = last.copy()
    for candidate in candidates[:-1]:
        alpha += candidate.share * (candidate.alpha - last)
    return alpha
