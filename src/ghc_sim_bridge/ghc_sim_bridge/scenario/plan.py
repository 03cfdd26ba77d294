"""The plan of one run: options, times, parameters and folder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ghc_sim_bridge.scenario.fields import Scenario
from ghc_sim_bridge.scenario.phase import Phase

MODES = ("lockstep", "realtime")
RECORD_MODES = ("decimated", "full")


@dataclass(frozen=True, slots=True)
class RunOptions:
    """Options of one run; None = as in the scenario."""

    formulation: str | None = None
    transition: float | None = None  # [s]
    torque_rate: float | None = None  # [Nm/s] budget of each transition; 0 = none
    control_dt: float | None = None  # [s]
    record: str = "decimated"
    view: bool = False
    mode: str = "lockstep"
    generators: bool | None = None  # False = raw values pass through; None = on, if any
    parameters: tuple[tuple[str, str, Any], ...] = ()  # (node, parameter, value)


@dataclass(frozen=True, slots=True)
class PlannedPhase:
    """A phase with its times; its transition comes first."""

    phase: Phase
    start: float  # [s]
    end: float  # [s]
    ramp: float  # [s] duration of the transition at its start


@dataclass(frozen=True, slots=True)
class RunPlan:
    """Complete specification of one run."""

    scenario: Scenario
    options: RunOptions
    formulation: str
    transition: float  # [s]
    torque_rate: float  # [Nm/s] budget of each transition, which can extend it; 0 = none
    control_dt: float  # [s]
    phases: tuple[PlannedPhase, ...]
    parameters: Mapping[str, Mapping[str, Any]]  # node -> parameter -> value
    folder: Path  # for all output of this run
    is_default: bool  # whether the scenario is unchanged by options
    changes: Mapping[str, Any] = field(default_factory=dict)  # robot changes

    @property
    def duration(self) -> float:
        """Simulated length of the run [s]."""
        return self.phases[-1].end
