"""Formulations by name: a new one is a new file in this folder, under `@register_formulation`."""

from __future__ import annotations

from typing import TypeVar

from ghc_controller.errors import InvalidValue
from ghc_controller.formulations.formulation import Formulation, FormulationSettings
from ghc_controller.qp import QpSolver, make_solver
from ghc_controller.registry import Registry

_F = TypeVar("_F", bound=type[Formulation])

FORMULATIONS: Registry[type[Formulation]] = Registry(
    "formulation",
    "ghc_controller.formulations",
    modules="ghc_controller.formulations",
    base=Formulation,
)
DEFAULT_FORMULATION = "cascade"


def register_formulation(kind: _F) -> _F:
    """Class decorator: makes a Formulation available under its `name`."""
    return FORMULATIONS.register(kind.name)(kind)


def make_formulation(
    name: str, settings: FormulationSettings | None = None, solver: QpSolver | None = None
) -> Formulation:
    """Formulation of that name.

    Raises:
        UnknownName: no such formulation; the message lists those that exist.
        PluginError: a package brings it and it cannot be loaded.
        InvalidValue: settings that it does not take, or its class has another name.
    """
    kind = FORMULATIONS[name]
    if getattr(kind, "name", None) != name:
        raise InvalidValue(
            f"formulation '{name}': its class {kind.__name__} must set name = '{name}'"
        )
    return kind(settings or FormulationSettings(), solver or make_solver("daqp"))


def blending_formulations() -> tuple[str, ...]:
    """Names of those that blend orders and so can keep a torque-rate budget."""
    return tuple(name for name, kind in FORMULATIONS.usable().items() if kind.blends)
