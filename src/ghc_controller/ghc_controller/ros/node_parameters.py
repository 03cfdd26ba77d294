"""Parameters of nodes as frozen dataclasses: declared, read and checked in one place."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import field, fields
from typing import Any, TypeVar

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

from ghc_controller.errors import ConfigurationError, UnknownName

P = TypeVar("P")
Check = Callable[[Any], str]  # value -> what is wrong with it, "" when nothing is

# Declared by rclpy itself in every node.
_OF_RCLPY = frozenset({"use_sim_time", "start_type_description_service"})
_TYPE_NAMES = {
    str: "a text",
    bool: "true or false",
    float: "a number",
    int: "an integer",
    tuple: "a list of texts",
}


def parameter(default: Any, description: str, check: Check | None = None) -> Any:
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


def several_of(*choices: str) -> Check:
    """Check: a list of distinct texts out of these."""

    def check(values: object) -> str:
        assert isinstance(values, tuple)
        good = set(values) <= set(choices) and len(set(values)) == len(values)
        return "" if good else "must be out of, each once: " + ", ".join(choices)

    return check


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
    return kind(**{name: _declared(node, entry) for name, entry in known.items()})


def _declared(node: Node, entry: Any) -> Any:
    """Checked value of one parameter, declared with its description and domain."""
    name, default, check = entry.name, entry.default, entry.metadata["check"]
    given_value = node.get_parameter(name).value if node.has_parameter(name) else None
    if node.has_parameter(name):  # declared from the command line, without a description
        node.undeclare_parameter(name)
    value = default if given_value is None else _typed(name, given_value, default)
    wrong = check(value) if check else ""
    if wrong:
        raise ConfigurationError(f"parameter '{name}': {given_value!r} given, {wrong}")
    descriptor = ParameterDescriptor(
        description=entry.metadata["description"],
        additional_constraints=_domain(default, check),
        read_only=True,
        dynamic_typing=True,  # 2 is as good as 2.0
    )
    node.declare_parameter(
        name, list(value) if isinstance(value, tuple) else value, descriptor, ignore_override=True
    )
    return value


def _typed(name: str, value: Any, default: Any) -> Any:
    if isinstance(default, float) and type(value) is int:
        return float(value)  # `-p stop_time:=2` means 2.0
    if isinstance(default, tuple) and isinstance(value, (list, tuple)):
        if all(isinstance(item, str) for item in value):
            return tuple(value)
    elif type(value) is type(default):
        return value
    expected = _TYPE_NAMES[type(default)]
    raise ConfigurationError(f"parameter '{name}': {value!r} given, {expected} expected")


def _domain(default: Any, check: Check | None) -> str:
    """What a check says of a value outside its domain."""
    outside: dict[type, Any] = {float: math.nan, str: ""}
    return check(outside[type(default)]) if check and type(default) in outside else ""


EXECUTOR = parameter(
    "events", "events (fast) or single (rclpy's default executor)", one_of("events", "single")
)
