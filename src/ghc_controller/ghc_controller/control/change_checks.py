"""What a running controller may change, and checks of a change before it begins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from ghc_controller.control import dials
from ghc_controller.control.dials import LIMITS, WEIGHTS, Dial
from ghc_controller.control.gain_check import (
    check_gain,
    check_obstacle_horizon,
    check_velocity_damping,
)
from ghc_controller.errors import ConfigurationError, InvalidValue, UnknownName
from ghc_controller.formulations import (
    Formulation,
    FormulationSettings,
    make_formulation,
    own_settings,
)
from ghc_controller.hierarchy import Solvability, TransitionSchedule
from ghc_controller.schema.declared import entries, flat
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import known_names, read
from ghc_controller.settings import Settings
from ghc_controller.types import Array

# What makes another formulation: it changes by a blend of answers.
CHOICES = (
    "formulation",
    *(
        entry.name
        for entry in flat(FormulationSettings)
        if entry.name not in (*WEIGHTS, "second_order")
    ),
)


class Controller(dials.Controller, Protocol):
    """What is used of a controller."""

    priorities: TransitionSchedule

    @property
    def has_stepped(self) -> bool:
        """Whether a step was made since the start or the last reset."""

    def judge(self, formulation: Formulation) -> Solvability:
        """Solvability of a formulation in the configuration last looked at."""


@dataclass(frozen=True, slots=True)
class Change:
    """A checked change, to be begun by `Tuning.begin`."""

    given: Mapping[str, Any]  # of Settings, by name
    goals: tuple[tuple[str, Dial, Array], ...]
    formulation: Formulation | None  # None: it stays
    own: Any  # settings that only this formulation has


class ChangeChecks:
    """Checks changes of one controller; nothing changes here."""

    def __init__(self, controller: Controller) -> None:
        self._controller = controller

    @property
    def names(self) -> tuple[str, ...]:
        """What can be changed, by the names of parameters."""
        return self._names(self._controller.settings.formulation)

    def check(self, values: Mapping[str, Any], under_way: Mapping[str, Array | None]) -> Change:
        """What these values would change; nothing changes yet.

        Args:
            values: by the names of `names`; gains one number or one per row.
            under_way: name -> goal of what still moves; None for a change of formulation.

        Raises:
            UnknownName, ConfigurationError: a name or value that is not known.
            InvalidValue: what cannot change while the controller runs, with the reason.
        """
        controller = self._controller
        gains = {
            name: values[name] for name in values if name in dials.gain_names(controller.robot)
        }
        given = {name: value for name, value in values.items() if name not in gains}
        self._check_names(given)
        settings = settings_with(given, controller.settings)
        check_velocity_damping(settings.optimization.velocity_damping, settings.control_dt)
        check_obstacle_horizon(settings.obstacle_horizon, settings.control_dt)
        goals = [(name, *self._gain(name, value)) for name, value in gains.items()]
        self._check_sampled({name: goal for name, _, goal in goals}, under_way)
        for name in given:
            if name in WEIGHTS:
                goal = np.array([getattr(settings.optimization, name)])
                goals.append((name, dials.weight_dial(controller, name), goal))
            elif name in LIMITS:
                dial = dials.limit_dial(controller, name)
                goal = np.broadcast_to(
                    dials.limit_goal(controller, name, settings), dial.read().shape
                )
                goals.append((name, dial, np.array(goal)))
        chosen = [name for name in given if name not in (*WEIGHTS, *LIMITS, "tuning_duration")]
        return Change(
            given,
            tuple(goals),
            self._formulation(chosen, settings, "formulation" in under_way),
            settings.own,
        )

    def _names(self, formulation: str) -> tuple[str, ...]:
        """What can be changed where this formulation is in use, or chosen by the change."""
        controller, own = self._controller, own_settings(formulation)
        gains = dials.gain_names(controller.robot)
        further = () if own is None else tuple(entry.name for entry in entries(own))
        return ("tuning_duration", *gains, *WEIGHTS, *LIMITS, *CHOICES, *further)

    def _check_names(self, given: Mapping[str, Any]) -> None:
        settings = self._controller.settings
        known = self._names(str(given.get("formulation", settings.formulation)))
        for name in given:
            if name in known:
                continue
            if name in known_names(Settings, given, settings):
                raise InvalidValue(
                    f"{name}: it holds from the start on; start the controller anew to change it"
                )
            raise UnknownName("parameter that changes while running", name, known)

    def _gain(self, name: str, value: Any) -> tuple[Dial, Array]:
        dial = dials.gain_dial(self._controller, name)
        size = len(dial.read())
        try:
            numbers = np.atleast_1d(np.asarray(value, dtype=np.float64))
        except (TypeError, ValueError) as error:  # parameters of gains may be of any type
            raise InvalidValue(f"{name}: {value!r} given, numbers >= 0 expected") from error
        if numbers.shape not in ((1,), (size,)):
            raise InvalidValue(f"{name}: {value} given, one number or {size} expected")
        if not (np.isfinite(numbers).all() and (numbers >= 0.0).all()):
            raise InvalidValue(f"{name}: {value} given, numbers >= 0 expected")
        return dial, np.array(np.broadcast_to(numbers, (size,)))

    def _check_sampled(
        self, goals: Mapping[str, Array], under_way: Mapping[str, Array | None]
    ) -> None:
        """Reject new gains that the control period cannot carry, each with its partner.

        One that moves counts with the larger of what it is and what it will be.
        """

        def largest(name: str) -> Array:
            now, goal = dials.gain_dial(self._controller, name).read(), under_way.get(name)
            return now if goal is None else np.maximum(now, goal)

        for task in {name.split(".")[1] for name in goals}:
            stiffness, damping = (
                goals[name] if name in goals else largest(name)
                for name in (f"tasks.{task}.{gain}" for gain in dials.GAINS)
            )
            dt = self._controller.settings.control_dt
            check_gain(f"tasks.{task}.damping", stiffness, damping, dt)

    def _formulation(
        self, chosen: list[str], settings: Settings, handing_over: bool
    ) -> Formulation | None:
        """The formulation under other settings; None where it stays. Raises InvalidValue."""
        controller = self._controller
        before = controller.settings
        if not chosen or _choices(settings) == _choices(before):
            return None
        new = make_formulation(
            settings.formulation,
            settings.optimization,
            controller.formulation.solver,
            settings.own,
        )
        if handing_over:
            raise InvalidValue(
                f"{chosen[0]}: a change of formulation is under way and takes "
                f"{before.tuning_duration:g} s; repeat this one after it"
            )
        running, waiting = controller.priorities.running, controller.priorities.pending
        if any(t.torque_rate > 0.0 for t in (running, *waiting) if t is not None):
            raise InvalidValue(
                f"{chosen[0]}: a transition with a torque rate runs or waits, which the "
                f"formulation in use ('{before.formulation}') paces; wait for its end"
            )
        solvable = controller.judge(new)
        for target in (controller.priorities.target, *(t.target for t in waiting)):
            solvable.check(controller.priorities.alpha, target.alpha, target.tasks)
        return new


def settings_with(given: Mapping[str, Any], base: Settings) -> Settings:
    """Settings with other values by name.

    Raises:
        ConfigurationError: a value of the wrong type or out of range.
    """
    return read(_Given(given, ""), Settings, base=base)


class _Given(Fields):
    """Values by the names of parameters; messages begin with the name."""

    def error(self, field: str, problem: str) -> ConfigurationError:
        return ConfigurationError(f"{field}: {problem}")

    def complaint(self, problem: str) -> ConfigurationError:
        return ConfigurationError(problem)


def _choices(settings: Settings) -> tuple[Any, ...]:
    """What makes another formulation of it: everything but its weights, which move."""
    same: dict[str, Any] = dict.fromkeys(WEIGHTS, 1.0)
    return settings.formulation, replace(settings.optimization, **same), settings.own
