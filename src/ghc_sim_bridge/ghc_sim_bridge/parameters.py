"""Parameters of the nodes of this package: frozen dataclasses, read and checked in one place."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any, TypeVar

from ghc_controller.errors import ConfigurationError, UnknownName
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

P = TypeVar("P")
Check = Callable[[Any], str]  # value -> what is wrong with it, "" when nothing is

# Declared by rclpy itself in every node.
_OF_RCLPY = frozenset({"use_sim_time", "start_type_description_service"})
_TYPE_NAMES = {str: "a text", bool: "true or false", float: "a number", int: "an integer"}


def parameter(default: Any, description: str, check: Check = lambda value: "") -> Any:
    """A dataclass field with what the ROS parameter of that name needs."""
    return field(default=default, metadata={"description": description, "check": check})


def positive(value: float) -> str:
    """Check: a finite number above zero."""
    return "" if math.isfinite(value) and value > 0.0 else "must be a finite number above 0"


def not_negative(value: float) -> str:
    """Check: a finite number, zero included."""
    return "" if math.isfinite(value) and value >= 0.0 else "must be a finite number, 0 or more"


def given(value: str) -> str:
    """Check: a text that is not empty."""
    return "" if value else "is needed"


def one_of(*choices: str) -> Check:
    """Check: one of the texts."""
    return lambda value: "" if value in choices else "must be one of: " + ", ".join(choices)


def read_parameters(node: Node, kind: type[P]) -> P:
    """Declare the fields of the dataclass `kind` on `node` and return their checked values.

    The node must be made with `automatically_declare_parameters_from_overrides=True`: only so
    can a misspelt name be told from a right one.

    Raises:
        ConfigurationError: a value has another type or is outside its domain.
        UnknownName: a parameter was given that the node does not have.
    """
    # `from __future__ import annotations` keeps types as text; defaults carry the same knowledge.
    known = {entry.name: entry for entry in fields(kind)}  # type: ignore[arg-type]
    for name in node.get_parameters_by_prefix(""):
        if name not in known and name not in _OF_RCLPY and not name.startswith("qos_overrides"):
            raise UnknownName("parameter", name, known)
    values = {}
    for name, entry in known.items():
        if not node.has_parameter(name):
            descriptor = ParameterDescriptor(
                description=entry.metadata["description"], read_only=True
            )
            node.declare_parameter(name, entry.default, descriptor)
        values[name] = _checked(name, node.get_parameter(name).value, entry.default, entry)
    return kind(**values)


def _checked(name: str, value: Any, default: Any, entry: Any) -> Any:
    if isinstance(default, float) and type(value) is int:
        value = float(value)  # `-p stop_time:=2` means 2.0
    if type(value) is not type(default):
        expected = _TYPE_NAMES[type(default)]
        raise ConfigurationError(f"parameter '{name}': {value!r} given, {expected} expected")
    wrong = entry.metadata["check"](value)
    if wrong:
        raise ConfigurationError(f"parameter '{name}': {value!r} given, {wrong}")
    return value


EXECUTOR = parameter(
    "events", "events (fast) or single (rclpy's default executor)", one_of("events", "single")
)


@dataclass(frozen=True, slots=True)
class BridgeParameters:
    """Parameters of sim_bridge."""

    scene: str = parameter("", "name of a scene, or path of its YAML file", given)
    mode: str = parameter("lockstep", "lockstep or realtime", one_of("lockstep", "realtime"))
    control_dt: float = parameter(0.001, "[s] control period", positive)
    physics_dt: float = parameter(0.001, "[s] physics step; divides control_dt", positive)
    stop_time: float = parameter(0.0, "[s] simulated end of the run; 0 = never", not_negative)
    paused: bool = parameter(False, "start paused; ~/pause starts the run")
    log_file: str = parameter("", "full-rate log (.npz) written at the end; empty = none")
    torque_rate_limit: float = parameter(0.0, "[Nm/s] of the gate; 0 = off", not_negative)
    watchdog_timeout: float = parameter(
        0.02, "[s] realtime: a robot without a command this fresh is held", positive
    )
    lockstep_timeout: float = parameter(
        10.0, "[s] wall: lockstep ends with an error when a state is not answered", positive
    )
    executor: str = EXECUTOR
    publish_contacts: bool = parameter(True, "publish contacts/<name>")
