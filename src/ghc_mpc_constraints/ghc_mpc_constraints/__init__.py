"""Constraint generators: bounds that move instead of jumping. The public names.

Names are loaded when they are first used, as in `ghc_controller`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ghc_controller.migration.public_names import load_name

if TYPE_CHECKING:
    from ghc_mpc_constraints.force_bounds import contact_force_bounds, contact_schedule
    from ghc_mpc_constraints.obstacle_motion import measurement, obstacle_bounds

    ContactForceBounds = contact_force_bounds.ContactForceBounds
    ContactSchedule = contact_schedule.ContactSchedule
    ForceBoundSettings = contact_force_bounds.ForceBoundSettings
    Measurement = measurement.Measurement
    ObstacleBounds = obstacle_bounds.ObstacleBounds
    ObstacleSettings = obstacle_bounds.ObstacleSettings

_HOMES = {
    "ContactForceBounds": "force_bounds.contact_force_bounds",
    "ContactSchedule": "force_bounds.contact_schedule",
    "ForceBoundSettings": "force_bounds.contact_force_bounds",
    "Measurement": "obstacle_motion.measurement",
    "ObstacleBounds": "obstacle_motion.obstacle_bounds",
    "ObstacleSettings": "obstacle_motion.obstacle_bounds",
}
__all__ = [*_HOMES]


def __getattr__(name: str) -> object:
    return load_name(__name__, _HOMES, name)
