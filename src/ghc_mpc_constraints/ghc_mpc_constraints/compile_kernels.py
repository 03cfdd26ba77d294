"""Compiles the generators' kernels into the cache beside their sources: `python -m` with this.

A generator compiles what it needs when it is made. With the cache filled that takes a fraction of
a second, without it some ten seconds.
"""

from __future__ import annotations

from ghc_mpc_constraints.force_bounds.contact_force_bounds import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_mpc_constraints.obstacle_motion.obstacle_bounds import ObstacleBounds, ObstacleSettings


def main() -> None:
    """Make one generator of each kind."""
    ContactForceBounds(ForceBoundSettings())
    ObstacleBounds(ObstacleSettings())


if __name__ == "__main__":
    main()
