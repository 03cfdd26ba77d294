"""What the plan of a scenario says of its controller: robot and transitions."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import ghc_controller as ghc
from ghc_controller.robot.library import find_robot
from ghc_sim_bridge.scenario.plan import PlannedPhase, RunPlan
from ghc_sim_bridge.scenario.robot_changes import write_changed_robot

LIMITS = ("velocity_limit", "position_limits", "velocity_limits")  # parameters of scenarios


def planned_robot(plan: RunPlan) -> ghc.Robot:
    """The scenario's robot with the changes of the plan."""
    with TemporaryDirectory() as folder:
        source = find_robot(plan.scenario.robot)
        changed = write_changed_robot(source, plan.changes, Path(folder) / "robot.yaml")
        return ghc.load_robot(str(changed))


def planned_transition(planned: PlannedPhase, names: tuple[str, ...]) -> ghc.Transition:
    """The transition that begins a phase.

    Args:
        names: tasks of the robot, in the order of its matrices.
    """
    phase = planned.phase
    if phase.table is None:
        matrix = ghc.matrix_from_hierarchy(names, phase.hierarchy)
    else:
        entries = [entry for row in phase.table.alpha for entry in row]
        matrix = ghc.PriorityMatrix.from_rows(names, phase.table.tasks, entries)
    return ghc.Transition(matrix, planned.start, planned.ramp, hierarchy=phase.hierarchy)
