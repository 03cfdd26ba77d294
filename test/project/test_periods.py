"""A period of a node is a whole number of nanoseconds, and one that is none is rejected."""

from __future__ import annotations

import pytest

from ghc_controller.errors import ConfigurationError, InvalidValue
from ghc_controller.ros.node_parameters import ParameterFields
from ghc_controller.ros.parameters import ControllerParameters
from ghc_controller.schema.record import read
from ghc_mpc_constraints.generator import GENERATORS
from ghc_mpc_constraints.ros.parameters import parameters_of
from ghc_sim_bridge.parameters import RecorderParameters


@pytest.mark.parametrize(
    ("kind", "given", "name"),
    [
        (ControllerParameters, {"robot": "kuka_lwr"}, "state_rate"),
        (ControllerParameters, {"robot": "kuka_lwr"}, "bounds_step"),
        (RecorderParameters, {"output": "here"}, "fast_rate"),
        *((parameters_of(GENERATORS[each]), {}, "step") for each in GENERATORS),
    ],
)
@pytest.mark.parametrize("value", [1e-300, 1e-10, 3e9, 1e300])
def test_a_period_of_zero_or_without_end_is_rejected(
    kind: type, given: dict[str, str], name: str, value: float
) -> None:
    """Rounded to zero, every message failed by a division; without end, the node."""
    with pytest.raises((ConfigurationError, InvalidValue), match=name):
        read(ParameterFields({**given, name: value}), kind)
