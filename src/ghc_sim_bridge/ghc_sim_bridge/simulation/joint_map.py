"""Joints by name: between the order in which a robot model counts them and that of MuJoCo.

Only joints of one coordinate occur here. The velocity of a floating base needs more than a
permutation (its linear part is in body axes for the robot model, in world axes for MuJoCo).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.errors import ConfigurationError, WrongSize
from ghc_controller.types import Array


class JointMap:
    """Permutation between the joints of the robot model and those of the simulator."""

    def __init__(self, model_names: Sequence[str], simulator_names: Sequence[str]) -> None:
        """Match both lists by name.

        Raises ConfigurationError naming the joints that either side lacks or has twice.
        """
        _refuse_doubles("robot model", model_names)
        _refuse_doubles("simulator", simulator_names)
        problems = [
            f"the {where} has no " + ", ".join(f"'{name}'" for name in missing)
            for where, missing in (
                ("simulator", [n for n in model_names if n not in simulator_names]),
                ("robot model", [n for n in simulator_names if n not in model_names]),
            )
            if missing
        ]
        if problems:
            raise ConfigurationError("joints do not match: " + "; ".join(problems))
        self.names = tuple(model_names)
        self._in_simulator = np.array([simulator_names.index(n) for n in model_names], dtype=int)

    def from_simulator(self, values: Array) -> Array:
        """Values (n,) or rows and columns (n, n) of the simulator, in the order of the model."""
        index = self._in_simulator
        self._check(values)
        return values[np.ix_(index, index)] if values.ndim == 2 else values[index]

    def to_simulator(self, values: Array) -> Array:
        """Values (n,) of the model, in the order of the simulator."""
        self._check(values)
        ordered = np.empty_like(values)
        ordered[self._in_simulator] = values
        return ordered

    def columns_from_simulator(self, matrix: Array) -> Array:
        """Columns (m, n) of a Jacobian, in the order of the model."""
        return matrix[:, self._in_simulator]

    def _check(self, values: Array) -> None:
        if values.shape[0] != len(self.names):
            raise WrongSize(
                f"values of the joints {', '.join(self.names)}", values.shape[0], len(self.names)
            )


def _refuse_doubles(where: str, names: Sequence[str]) -> None:
    doubles = sorted({name for name in names if names.count(name) > 1})
    if doubles:
        raise ConfigurationError(f"the {where} has joints twice: {', '.join(doubles)}")
