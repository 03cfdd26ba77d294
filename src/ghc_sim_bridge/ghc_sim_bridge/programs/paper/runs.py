"""The runs of `paper`: all experiments of the GHC paper, and comparisons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ghc_controller.errors import UnknownName
from ghc_controller.safety.torque_gate import DEFAULT_TORQUE_RATE
from ghc_sim_bridge.scenario.plan import RunOptions, RunPlan
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario

_AT_ONCE = 0.005  # [s] the paper's fast transition
_RATE_LIMIT = DEFAULT_TORQUE_RATE  # [Nm/s] default limit of robots


@dataclass(frozen=True, slots=True)
class PaperRun:
    """One run; `--only` and the document refer to it by `name`."""

    name: str
    scenario: str
    variant: str = ""
    options: RunOptions = field(default_factory=RunOptions)

    def plan(self, output: Path) -> RunPlan:
        """The plan of this run below the root of all results."""
        return make_plan(load_scenario(self.scenario, self.variant), self.options, output)


def _switching(name: str, formulation: str, transition: float | None = None) -> PaperRun:
    options = RunOptions(formulation=formulation, transition=transition)
    return PaperRun(name, "priority_switching", options=options)


def _both(name: str, scenario: str, variant: str = "") -> tuple[PaperRun, PaperRun]:
    """A scenario with the default formulation and with the paper's."""
    own = RunOptions(formulation=PAPERS_OWN)
    return (
        PaperRun(name, scenario, variant),
        PaperRun(beside(name), scenario, variant, own),
    )


def _pairs(scenario: str) -> tuple[PaperRun, ...]:
    """A scenario of the thesis with raw and with smoothed bounds, in both formulations."""
    return tuple(
        PaperRun(
            f"{name}{'' if smoothed else '_off'}",
            scenario,
            options=RunOptions(formulation=formulation, generators=smoothed),
        )
        for name, formulation in ((scenario, None), (beside(scenario), PAPERS_OWN))
        for smoothed in (False, True)
    )


PAPERS_OWN = "ghc"  # formulation of the paper, run in addition to the default one


def beside(name: str) -> str:
    """Name of the run with the paper's formulation that belongs to a run with the default one."""
    return f"{name}_{PAPERS_OWN}"


# Runs of `_pairs`, by the name of the run with smoothed bounds.
GENERATOR_PAIRS = {
    name: f"{name}_off"
    for scenario in ("force_bound_step", "obstacle_jump")
    for name in (scenario, beside(scenario))
}
STUDIES = "studies"  # of the generators, without a robot

PAPER_RUNS = (
    _switching("cascade", "cascade"),
    _switching("ghc", "ghc"),
    _switching("balanced", "balanced"),
    _switching("ghc_full", "ghc_full"),
    _switching("weighted", "weighted"),
    _switching("hqp", "hqp"),
    _switching("cascade_fast", "cascade", _AT_ONCE),
    _switching("ghc_fast", "ghc", _AT_ONCE),
    PaperRun(
        "hqp_braked",
        "priority_switching",
        options=RunOptions(
            formulation="hqp", parameters=(("controller", "hqp_damps_velocity", True),)
        ),
    ),
    PaperRun(
        "hqp_gated",
        "priority_switching",
        options=RunOptions(
            formulation="hqp",
            parameters=(
                ("controller", "torque_rate_limit", _RATE_LIMIT),
                ("sim_bridge", "torque_rate_limit", _RATE_LIMIT),
            ),
        ),
    ),
    *_both("insertion_removal", "insertion_removal"),
    *_both("lemniscate", "lemniscate"),
    *_both("contact_force", "contact_force"),
    *_both("nonstrict_0.2", "nonstrict", "alpha_12_0.2"),
    *_both("nonstrict_0.5", "nonstrict", "alpha_12_0.5"),
    *_both("nonstrict_0.8", "nonstrict", "alpha_12_0.8"),
    *_pairs("force_bound_step"),
    *_pairs("obstacle_jump"),
)


def choose_runs(names: Sequence[str]) -> tuple[PaperRun, ...]:
    """Runs by name or by scenario, all if none is given; not including `studies`.

    Raises UnknownName.
    """
    if not names:
        return PAPER_RUNS
    chosen: list[PaperRun] = []
    for name in names:
        if name == STUDIES:
            continue
        found = [run for run in PAPER_RUNS if name in (run.name, run.scenario)]
        if not found:
            known = dict.fromkeys(key for run in PAPER_RUNS for key in (run.name, run.scenario))
            raise UnknownName("paper run", name, (*known, STUDIES))
        chosen += [run for run in found if run not in chosen]
    return tuple(chosen)


def wants_studies(names: Sequence[str]) -> bool:
    """Whether the studies are selected, by name or by default."""
    return not names or STUDIES in names
