"""Short declarations of what only a node has as a parameter, without ROS."""

from __future__ import annotations

from typing import Any

from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import (
    NOT_NEGATIVE,
    PLAN_STEP,
    POSITIVE,
    RATE,
    Distinct,
    Domain,
    NotEmpty,
    OneOf,
)

positive, not_negative, given = POSITIVE, NOT_NEGATIVE, NotEmpty()
rate, plan_step = RATE, PLAN_STEP


def parameter(default: Any, description: str, domain: Domain | None = None) -> Any:
    """Declaration of a parameter that only a node has; a unit stands first, as "[s] wall"."""
    unit, found, text = description.removeprefix("[").partition("] ")
    if not (found and description.startswith("[")):
        unit, text = "", description
    return declared(text, default, unit=unit, domain=domain)


def one_of(*choices: str) -> Domain:
    """Domain: one of the texts."""
    return OneOf(choices)


def several_of(*choices: str) -> Domain:
    """Domain: a list of distinct texts out of these."""
    return Distinct(choices)


EXECUTOR = parameter(
    "events", "events (fast) or single (rclpy's default executor)", one_of("events", "single")
)
