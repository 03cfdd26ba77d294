"""Errors of the stack; messages state what was given, what was expected and what exists."""

from __future__ import annotations

from collections.abc import Iterable


class GhcError(Exception):
    """Root of every error that this stack raises on purpose."""


class UnknownName(GhcError):
    """A name that does not exist; carries the ones that do."""

    def __init__(self, kind: str, given: str, known: Iterable[str]) -> None:
        self.kind = kind
        self.given = given
        self.known = tuple(known)
        existing = ", ".join(self.known) if self.known else "none"
        super().__init__(f"unknown {kind} '{given}'; known: {existing}")


class WrongSize(GhcError):
    """A value with the wrong number of entries."""

    def __init__(self, what: str, given: object, expected: object) -> None:
        self.what = what
        self.given = given
        self.expected = expected
        super().__init__(f"{what}: size {given} given, {expected} expected")


class InvalidValue(GhcError):
    """A value outside its domain (not finite, out of range, malformed)."""


class OutsideLimits(InvalidValue):
    """A joint outside its position limits; carries its name, value and limits [rad] or [m]."""

    def __init__(self, joint: str, value: float, lower: float, upper: float) -> None:
        self.joint = joint
        self.value = value
        self.lower = lower
        self.upper = upper
        super().__init__(f"joint '{joint}': {value:g} given, {lower:g} to {upper:g} expected")


class InvalidField(InvalidValue):
    """A field of a record outside its domain; carries its name for the reader of the file."""

    def __init__(self, field: str, problem: str) -> None:
        self.field = field
        self.problem = problem
        super().__init__(f"{field}: {problem}")


class ConfigurationError(GhcError):
    """A file or parameter that cannot be used; names the file and the field."""


class PluginError(ConfigurationError):
    """An invalid plug-in of another package; names package and entry."""
