"""What a run with constraint generators did: from its log and the bounds that it obeyed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ghc_controller.contacts.contact import contact_axes
from ghc_controller.robot.library import find_robot, load_robot
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_controller.settings import Settings
from ghc_controller.types import Array
from ghc_sim_bridge.analysis.analysis import Analysis
from ghc_sim_bridge.analysis.generator_metrics import (
    ForceFollowing,
    event_peaks,
    event_windows,
    force_following,
)
from ghc_sim_bridge.analysis.limit_history import (
    LimitHistory,
    limit_histories,
    margin_histories,
)
from ghc_sim_bridge.analysis.obstacle_distance import DistanceHistory, obstacle_distance
from ghc_sim_bridge.logs.constraint_series import ConstraintSeries
from ghc_sim_bridge.scene.description import load_scene

CONSTRAINTS = "constraints.npz"


@dataclass(frozen=True, slots=True)
class GeneratorAnalysis:
    """A run and everything about its bounds."""

    analysis: Analysis
    series: ConstraintSeries
    windows: tuple[tuple[float, float], ...]  # [s] around each event of the scenario
    peaks: tuple[float, ...]  # [Nm/s] largest torque rate in each window
    forces: Mapping[str, Array]  # contact -> (T,) [N] simulated, along its normal
    following: Mapping[str, ForceFollowing]
    distances: Mapping[str, DistanceHistory]
    limits: Mapping[str, LimitHistory]  # "joint_limits/joint_1" and the like

    def summary(self) -> dict[str, Any]:
        """The part of summary.json on bounds and events."""
        events = self.analysis.plan.scenario.events
        return {
            "events": [
                {"name": event.name, "time_s": event.time, "window_s": list(window), "peak": peak}
                for event, window, peak in zip(events, self.windows, self.peaks, strict=True)
            ],
            "contacts": {name: asdict(values) for name, values in self.following.items()},
            "obstacles": {
                name: {
                    "qp_violation_m": history.violation,
                    "closer_than_safe_m": history.closest,
                    "inside_safe_distance_s": history.time_inside,
                }
                for name, history in self.distances.items()
            },
            "limits": {
                name: {
                    "looser_than_raw": history.looser_than_raw,
                    "beyond_raw": history.beyond_raw,
                    "beyond_in_force": history.beyond_in_force,
                }
                for name, history in self.limits.items()
            },
        }


def analyse_generators(analysis: Analysis, series: ConstraintSeries) -> GeneratorAnalysis:
    """Peaks per event, and how bounds and distances were kept."""
    log, plan = analysis.log, analysis.plan
    windows = event_windows(plan.scenario.events, plan.duration)
    normals = _contact_normals(plan.folder, plan.scenario.robot)
    forces = {
        name: log.wrenches[name][:, :3] @ normals[name]
        for name in series.contacts
        if name in normals and name in log.wrenches
    }
    horizon = _obstacle_horizon(plan.parameters["controller"])
    return GeneratorAnalysis(
        analysis=analysis,
        series=series,
        windows=windows,
        peaks=event_peaks(log, windows),
        forces=forces,
        following={
            name: force_following(series, name, log.time, force) for name, force in forces.items()
        },
        distances={
            obstacle.id: obstacle_distance(series, obstacle, log, analysis.robot.model, horizon)
            for obstacle in load_scene(plan.scenario.scene).obstacles
            if obstacle.id in series.obstacles
        },
        limits={
            **limit_histories(series, plan.scenario, log),
            **margin_histories(series, plan.scenario, log, analysis.robot),
        },
    )


def _contact_normals(folder: Path, robot: str) -> dict[str, Array]:
    """Contact -> (3,) unit normal, world axes, of the robot file of a run.

    Raises ConfigurationError (no vector of three numbers) or InvalidValue (no direction).
    """
    changed = folder / "robot.yaml"
    fields = read_yaml(changed if changed.is_file() else find_robot(robot))
    return dict(_contact_normal(contact) for contact in fields.sections("contacts", optional=True))


def _contact_normal(contact: Fields) -> tuple[str, Array]:
    """Name and unit normal, made as the controller makes it: in the file any length will do."""
    name = contact.text("name")
    return name, contact_axes(np.array(contact.vector("normal", 3)), name)[2]


def _obstacle_horizon(parameters: Mapping[str, Any]) -> float:
    """delta t of eq. 4.2 [s]: a parameter of the run, else of the robot."""
    given = parameters.get("obstacle_horizon")
    if given is not None:
        return float(given)
    return Settings.for_robot(load_robot(parameters["robot"])).obstacle_horizon
