"""YAML mappings read field by field; errors name file, field, what was given and what exists.

A `Fields` wraps one mapping. Each reader takes a field's name, checks its type and marks it as
read; `close()` then refuses whatever was not read, so that a misspelt field is never ignored.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from ghc_controller.errors import ConfigurationError

_MISSING = object()


def read_yaml(path: Path) -> dict[str, Any]:
    """Top-level mapping of a YAML file.

    Raises ConfigurationError when the file cannot be read or is not a mapping.
    """
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        reason = " ".join(str(error).split())
        raise ConfigurationError(f"{path}: not valid YAML: {reason}") from error
    if not isinstance(data, dict):
        raise ConfigurationError(f"{path}: a mapping is expected, {_shown(data)} given")
    return data


class Fields:
    """One mapping of a file, read field by field."""

    def __init__(self, data: object, file: Path, where: str = "") -> None:
        self.file = file
        self.where = where
        if not isinstance(data, Mapping):
            raise self.error("", f"a mapping is expected, {_shown(data)} given")
        self._data: Mapping[str, Any] = data
        self._read: set[str] = set()

    def error(self, field: str, problem: str) -> ConfigurationError:
        """The error of one field of this mapping, to be raised by the caller."""
        name = f"{self.where}.{field}".strip(".")
        return ConfigurationError(
            f"{self.file}: {name}: {problem}" if name else f"{self.file}: {problem}"
        )

    def has(self, field: str) -> bool:
        """Whether the field is present and not null."""
        return self._data.get(field) is not None

    def names(self) -> tuple[str, ...]:
        """The names of all fields, as text."""
        return tuple(str(name) for name in self._data)

    def value(self, field: str, default: Any = _MISSING) -> Any:
        """The raw value of a field; an error when it is missing and has no default."""
        self._read.add(field)
        value = self._data.get(field)
        if value is None:
            if default is _MISSING:
                raise self.error(field, f"is missing; given: {_names(self._data)}")
            return default
        return value

    def text(self, field: str, default: Any = _MISSING) -> str:
        """A string."""
        value = self.value(field, default)
        if not isinstance(value, str):
            raise self.error(field, f"a text is expected, {_shown(value)} given")
        return value

    def number(self, field: str, default: Any = _MISSING, minimum: float = -math.inf) -> float:
        """A finite number, at least `minimum`."""
        return self._finite(field, self.value(field, default), minimum)

    def vector(self, field: str, default: Any = _MISSING) -> tuple[float, ...]:
        """A list of finite numbers."""
        value = self.value(field, default)
        if not isinstance(value, Sequence) or isinstance(value, str):
            raise self.error(field, f"a list of numbers is expected, {_shown(value)} given")
        return tuple(self._finite(f"{field}[{k}]", x, -math.inf) for k, x in enumerate(value))

    def section(self, field: str, default: Any = _MISSING) -> Fields:
        """A mapping inside this one."""
        return Fields(self.value(field, default), self.file, f"{self.where}.{field}".strip("."))

    def items(self, field: str, default: Any = _MISSING) -> tuple[Fields, ...]:
        """A list of mappings."""
        value = self.value(field, default)
        if not isinstance(value, Sequence) or isinstance(value, str):
            raise self.error(field, f"a list is expected, {_shown(value)} given")
        where = f"{self.where}.{field}".strip(".")
        return tuple(Fields(x, self.file, f"{where}[{k}]") for k, x in enumerate(value))

    def close(self) -> None:
        """Refuse fields that no reader asked for."""
        unknown = [str(name) for name in self._data if name not in self._read]
        if unknown:
            known = ", ".join(sorted(self._read))
            raise self.error(unknown[0], f"unknown field; known: {known}")

    def _finite(self, field: str, value: object, minimum: float) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(field, f"a number is expected, {_shown(value)} given")
        if not math.isfinite(value):
            raise self.error(field, f"a finite number is expected, {value} given")
        if value < minimum:
            raise self.error(field, f"at least {minimum:g} is expected, {value:g} given")
        return float(value)


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _names(data: Mapping[str, Any]) -> str:
    return ", ".join(str(name) for name in data) or "nothing"
