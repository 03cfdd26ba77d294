"""What is compared: the formulations, and the variants of their papers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import ghc_controller as ghc
from ghc_controller.formulations import DEFAULT_FORMULATION, DampedLevels


@dataclass(frozen=True, slots=True)
class Method:
    """A formulation with the settings that differ from those of the case."""

    name: str  # also a file name
    formulation: str
    changes: Mapping[str, Any] = field(default_factory=dict)  # of FormulationSettings

    def settings(self, **of_case: Any) -> ghc.FormulationSettings:
        """Settings of the case with the changes of the method."""
        return ghc.FormulationSettings(**(of_case | dict(self.changes)))


REFERENCE = DEFAULT_FORMULATION  # compared with each of the others
METHODS = {name: Method(name, name) for name in ghc.FORMULATIONS}
UNDAMPED = {  # the laws of Jeong and Chang (2009) without damping
    f"{name}_undamped": Method(
        f"{name}_undamped", name, {"damped_levels": DampedLevels.NONE, "velocity_damping": 0.0}
    )
    for name in ("task_priority", "resolved_acceleration", "operational_space", "unifying")
}
