"""Parameters of a generator node: settings of the generator, and of the node."""

from __future__ import annotations

from dataclasses import make_dataclass
from functools import cache
from typing import Any

from ghc_controller.schema.declared import inline
from ghc_controller.schema.parameters import EXECUTOR, not_negative, parameter
from ghc_mpc_constraints.generator import GENERATORS, Generator, Schedules

_TAKE_OVER = "[s] wall: wait for the current bounds and inputs before the first plan"
_SENSOR_PERIOD = (
    "[s] of the robot's time: ticks at its multiples wait for the input of their stamp; 0 = never"
)
_LOCKSTEP = "reject inputs that would make a run depend on their time of arrival"


def parameters_of(generator: type[Generator]) -> type[Any]:
    """Dataclass with the parameters of the node that runs a generator.

    Fields: `settings`; `lockstep` and the names allowed in schedules, or `sensor_period`;
    `take_over_timeout` and `executor`.
    """
    return _parameters(generator)


def generator_parameters(name: str) -> type[Any]:
    """As above, by the name of the generator; raises as `GENERATORS[name]`."""
    return parameters_of(GENERATORS[name])


@cache
def _parameters(generator: type[Generator]) -> type[Any]:
    given = generator.input
    fields: list[tuple[str, Any, Any]] = [
        ("settings", generator.settings_type, inline(generator.settings_type))
    ]
    if isinstance(given, Schedules):
        names = parameter((), "names that schedules may use; none = any")
        fields += [(given.names, tuple[str, ...], names)]
        fields += [("lockstep", bool, parameter(False, _LOCKSTEP))]
    else:
        fields += [("sensor_period", float, parameter(0.0, _SENSOR_PERIOD, not_negative))]
    fields += [("take_over_timeout", float, parameter(0.5, _TAKE_OVER, not_negative))]
    fields += [("executor", str, EXECUTOR)]
    name = f"{generator.__name__}Parameters"
    doc = {"__doc__": f"Parameters of the node that runs {generator.__name__}."}
    return make_dataclass(name, fields, namespace=doc, frozen=True, slots=True)
