"""Runs targets for a number of cases, and reports the results."""

from __future__ import annotations

import math
import resource
import time
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from random import Random
from typing import Any

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from benchmarks.fuzz.target import Target

EDITS = 24  # [-] cases made of each one that hypothesis draws
CHAIN = 3  # [-] edits one after the other, before it starts from what was drawn again
BATCH = 2000  # [-] draws of one run of hypothesis, which remembers all of a run
REPEATS = 5  # [-] of a slow case: the fastest one counts, the others met other programs
MEMORY_GOAL = 64.0  # [MB] of growth of a target after its first batch
_KB = 1024.0 / 1e6  # [MB]


@dataclass(slots=True)
class Outcome:
    """Result of a target."""

    target: Target
    cases: int = 0
    accepted: int = 0
    slowest: float = 0.0  # [s] of CPU
    slowest_case: str = ""
    growth: float = 0.0  # [MB] of resident memory after the first batch
    failures: list[str] = field(default_factory=list)

    @property
    def holds(self) -> bool:
        """No undocumented error, within the budget of CPU and the goal of memory."""
        return (
            not self.failures and self.slowest <= self.target.budget and self.growth <= MEMORY_GOAL
        )


def run_target(target: Target, cases: int, first_seed: int = 0) -> Outcome:
    """Fuzz one target with at least so many cases; stops at a batch that fails."""
    outcome = Outcome(target)

    def judge(case: Any) -> None:
        outcome.cases += 1
        taken, accepted = _time(target, case)
        if taken > target.budget:
            taken = min([taken, *(_time(target, case)[0] for _ in range(REPEATS))])
        outcome.accepted += accepted
        if taken > outcome.slowest:
            outcome.slowest, outcome.slowest_case = taken, repr(case)[:400]

    def one(drawn: Any, number: int) -> None:
        random, case = Random(number), deepcopy(drawn)
        try:
            judge(case)
            for k in range(EDITS):
                case = target.edit(case if k % CHAIN else deepcopy(drawn), random)
                judge(case)
        except Exception as error:
            error.add_note(f"case {repr(case)[:800]}")
            raise

    begun = math.nan
    draws = math.ceil(cases / (EDITS + 1))
    for batch in range(math.ceil(draws / BATCH)):
        count = min(BATCH, draws - batch * BATCH)
        fuzz = seed(first_seed + batch)(
            settings(
                max_examples=count,
                database=None,
                deadline=None,
                phases=(Phase.generate, Phase.shrink),
                suppress_health_check=list(HealthCheck),
            )(given(target.cases, st.integers(0, 2**32))(one))
        )
        try:
            fuzz()
        except Exception as error:
            notes = " ".join(getattr(error, "__notes__", []))
            outcome.failures.append(f"{type(error).__name__}: {error} {notes}"[:2000])
            break
        begun = _resident() if batch == 0 else begun
    if not math.isnan(begun):
        outcome.growth = max(_resident() - begun, 0.0)
    return outcome


def _time(target: Target, case: Any) -> tuple[float, bool]:
    """CPU of this thread [s] for a case, and whether it was accepted."""
    begun = time.thread_time()
    try:
        target.run(case)
    except target.documented:
        return time.thread_time() - begun, False
    return time.thread_time() - begun, True


def _resident() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * _KB


def table(outcomes: Sequence[Outcome]) -> str:
    """One line per target."""
    lines = [
        f"{'target':20} {'cases':>8} {'accepted':>8} {'slowest [ms]':>12} {'growth [MB]':>11}"
    ]
    for o in outcomes:
        lines.append(
            f"{o.target.name:20} {o.cases:8} {o.accepted:8} {1e3 * o.slowest:12.2f} "
            f"{o.growth:11.1f}  {'holds' if o.holds else 'FAILS'}"
        )
        lines += [f"    {text}" for text in o.failures]
        if o.slowest > o.target.budget:
            lines.append(f"    slow: {o.slowest_case}")
    total = sum(o.cases for o in outcomes)
    lines.append(f"{'total':20} {total:8}")
    return "\n".join(lines)
