"""Node parameters: dataclasses, checked as fields of files and declared to ROS."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Container, Mapping
from enum import Enum
from typing import Any, TypeVar

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.migration.names import Kind, hint
from ghc_controller.schema.declared import flat_values
from ghc_controller.schema.domains import Domain, NotEmpty, Range
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import known_names, read

P = TypeVar("P")

# Declared by rclpy in every node.
_OF_RCLPY = frozenset({"use_sim_time", "start_type_description_service"})


class ParameterFields(Fields):
    """Parameters passed to a node; messages call them parameters."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        super().__init__(values, "parameters")

    def error(self, field: str, problem: str) -> ConfigurationError:
        """Error about one parameter."""
        return ConfigurationError(f"parameter '{field}': {problem}")

    def complaint(self, problem: str) -> ConfigurationError:
        """Error about several parameters."""
        return ConfigurationError(problem)


def read_parameters(
    node: Node,
    kind: type[P],
    base: Callable[[Fields], P | None] = lambda _: None,
    changing: Container[str] = (),
) -> P:
    """Declare the fields of the dataclass `kind` on `node` and return their checked values.

    Inlined fields are parameters like the others. Create the node with
    `automatically_declare_parameters_from_overrides=True`: otherwise misspelled names are not
    detected.

    Args:
        base: values for parameters that are not given, instead of the defaults of `kind`.
        changing: names of parameters that can be set while the node runs.

    Raises:
        ConfigurationError: a value has another type or is outside its domain.
        UnknownName: an unknown parameter was given.
    """
    ours = {
        name: value
        for name, value in node.get_parameters_by_prefix("").items()
        if name not in _OF_RCLPY and not name.startswith("qos_overrides")
    }
    given_values = ParameterFields({name: item.value for name, item in ours.items()})
    below = base(given_values)
    known = list(known_names(kind, given_values.values, below))
    for name in ours:
        if name not in known:
            words = hint(Kind.FIELD, name)
            if words:
                raise ConfigurationError(f"parameter '{name}': {words}")
            raise UnknownName("parameter", name, known)
    record = read(given_values, kind, base=below)
    for entry, value in flat_values(record):
        domain = entry.declaration.domain
        if isinstance(domain, NotEmpty) and domain.problem(value):  # a required value
            raise given_values.error(entry.name, domain.problem(value))
        if node.has_parameter(entry.name):  # declared from outside, without a description
            node.undeclare_parameter(entry.name)
        descriptor = ParameterDescriptor(
            description=entry.meaning,
            additional_constraints="" if domain is None else domain.words,
            floating_point_range=_range(domain),
            read_only=entry.name not in changing,
            dynamic_typing=True,  # accept 2 for 2.0
        )
        node.declare_parameter(entry.name, _as_ros(value), descriptor, ignore_override=True)
    return record


def _range(domain: Domain | None) -> list[FloatingPointRange]:
    """The ROS descriptor of a closed range; empty for other domains."""
    if not isinstance(domain, Range):
        return []
    lowest = max(domain.minimum, domain.above)
    if not math.isfinite(lowest):
        return []
    highest = domain.maximum if math.isfinite(domain.maximum) else sys.float_info.max
    return [FloatingPointRange(from_value=lowest, to_value=highest)]


def _as_ros(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    return list(value) if isinstance(value, tuple) else value
