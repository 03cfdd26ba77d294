"""Formulations by name: a new one is a new file in this folder, under `@register_formulation`."""

from __future__ import annotations

from typing import Any, TypeVar

from ghc_controller.errors import InvalidValue, UnknownName
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
    name: str,
    settings: FormulationSettings | None = None,
    solver: QpSolver | None = None,
    own: Any = None,
) -> Formulation:
    """Formulation of that name.

    Args:
        own: settings that only this formulation has; defaults when not given.

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
    given = (settings or FormulationSettings(), solver or make_solver("daqp"))
    of_its_own = kind.own_settings
    if of_its_own is None and own is None:
        return kind(*given)
    if of_its_own is None or not isinstance(own, of_its_own | None):
        expected = "none" if of_its_own is None else of_its_own.__name__
        raise InvalidValue(
            f"formulation '{name}': own settings {own!r} given, {expected} expected"
        )
    return kind(*given, of_its_own() if own is None else own)  # type: ignore[call-arg]


def own_settings(name: str) -> type | None:
    """Dataclass of the settings that only this formulation has.

    None if it has none, or if no formulation has that name (see make_formulation). Raises
    PluginError.
    """
    try:
        return FORMULATIONS[name].own_settings
    except UnknownName:
        return None


def blending_formulations() -> tuple[str, ...]:
    """Names of those that blend orders and so can keep a torque-rate budget."""
    return tuple(name for name, kind in FORMULATIONS.usable().items() if kind.blends)
