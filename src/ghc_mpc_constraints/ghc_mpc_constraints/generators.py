"""Constraint generators by name: the node of each, and what it reads and plans."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.registry import Registry

FORCE_BOUNDS = "contact_force_bounds"
OBSTACLE_MOTION = "obstacle_motion"


@dataclass(frozen=True, slots=True)
class GeneratorNode:
    """A generator as a scenario starts it.

    It takes the parameters of the generator of this repository that plans the same.
    """

    package: str  # of its executable
    executable: str
    plan: str  # FORCE_BOUNDS or OBSTACLE_MOTION: what the controller waits for
    reads: str  # topic of its input, to which it subscribes before time runs

    @property
    def reads_schedules(self) -> bool:
        """Whether the scripted contact schedules are its input."""
        return self.plan == FORCE_BOUNDS


GENERATORS: Registry[GeneratorNode] = Registry(
    "generator", "ghc_mpc_constraints.generators", instance_of=GeneratorNode
)
GENERATORS.register("contact_force_bounds")(
    GeneratorNode(
        "ghc_mpc_constraints",
        "contact_force_bounds",
        FORCE_BOUNDS,
        "constraints/contact_schedule",
    )
)
GENERATORS.register("obstacle_bounds")(
    GeneratorNode(
        "ghc_mpc_constraints", "obstacle_bounds", OBSTACLE_MOTION, "constraints/obstacles"
    )
)
