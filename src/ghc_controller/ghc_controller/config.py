"""Reads a YAML file field by field; every complaint names the file, the field and the remedy."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from ghc_controller.errors import ConfigurationError
from ghc_controller.types import Array

_MISSING: Any = object()


class Fields:
    """One mapping of a configuration file; each reader removes its field from `unread`.

    A reader without `default` makes the field required. `done()` refuses what nobody read, so
    that a misspelt optional field is an error and not a silent default.
    """

    def __init__(self, values: object, source: str, prefix: str = "") -> None:
        """Wrap `values`; `source` (the file) and `prefix` (dotted path) go into messages."""
        self._source = source
        self._prefix = prefix
        if not isinstance(values, Mapping):
            raise ConfigurationError(
                f"{source}: {prefix.rstrip('.') or 'file'}: a mapping expected,"
                f" {_shown(values)} given"
            )
        self._values: dict[str, Any] = {str(key): value for key, value in values.items()}
        self._known: list[str] = []

    def error(self, field: str, problem: str) -> ConfigurationError:
        """Error about one field, with the file and the full path of the field."""
        return ConfigurationError(f"{self._source}: {self._prefix}{field}: {problem}")

    def complaint(self, problem: str) -> ConfigurationError:
        """Error about the mapping as a whole."""
        return ConfigurationError(f"{self._source}: {self._prefix.rstrip('.')}: {problem}")

    def has(self, field: str) -> bool:
        """Whether the field is given; marks it as known."""
        self._known.append(field)
        return field in self._values

    def value(self, field: str) -> Any:
        """Whatever the field holds, for a reader of its own."""
        return self._get(field, _MISSING)

    def text(self, field: str, default: str = _MISSING) -> str:
        """A non-empty string."""
        value = self._get(field, default)
        if not isinstance(value, str) or not value:
            raise self.error(field, f"a name expected, {_shown(value)} given")
        return value

    def choice(self, field: str, known: Sequence[str]) -> str:
        """One of the known names."""
        value = self.text(field)
        if value not in known:
            raise self.error(field, f"'{value}' given; known: {', '.join(known)}")
        return value

    def flag(self, field: str, default: bool = _MISSING) -> bool:
        """True or false."""
        value = self._get(field, default)
        if not isinstance(value, bool):
            raise self.error(field, f"true or false expected, {_shown(value)} given")
        return value

    def number(self, field: str, default: float = _MISSING, minimum: float = -math.inf) -> float:
        """A finite number, at least `minimum`."""
        value = self._get(field, default)
        if not _is_number(value) or value < minimum:
            at_least = f" >= {minimum:g}" if minimum > -math.inf else ""
            raise self.error(field, f"a number{at_least} expected, {_shown(value)} given")
        return float(value)

    def numbers(self, field: str, size: int) -> list[float]:
        """`size` finite numbers; one number stands for `size` equal ones."""
        value = self._get(field, _MISSING)
        if _is_number(value):
            return [float(value)] * size
        if not isinstance(value, list) or len(value) != size or not all(map(_is_number, value)):
            raise self.error(field, f"{size} numbers expected, {_shown(value)} given")
        return [float(item) for item in value]

    def points(self, field: str) -> Array:
        """At least one point of three finite numbers, (p, 3)."""
        value = self._get(field, _MISSING)
        if not isinstance(value, list) or not value or not all(map(_is_point, value)):
            raise self.error(field, f"a list of points [x, y, z] expected, {_shown(value)} given")
        return np.array(value, dtype=np.float64)

    def number_or_map(self, field: str) -> float | dict[str, float] | None:
        """One number, or a mapping name -> number; None when the field is absent."""
        value = self._get(field, None)
        if value is None or _is_number(value):
            return value
        if isinstance(value, Mapping) and all(map(_is_number, value.values())):
            return {str(key): float(item) for key, item in value.items()}
        raise self.error(
            field, f"a number or a mapping name: number expected, {_shown(value)} given"
        )

    def names(
        self, field: str, known: Sequence[str], default: Sequence[str] = _MISSING
    ) -> tuple[str, ...]:
        """Distinct names out of `known`."""
        value = self._get(field, default)
        if not isinstance(value, (list, tuple)) or not value:
            raise self.error(field, f"a list of names expected, {_shown(value)} given")
        for name in value:
            if name not in known:
                raise self.error(field, f"'{name}' given; known: {', '.join(known)}")
        if len(set(value)) != len(value):
            raise self.error(field, f"names must differ, {_shown(value)} given")
        return tuple(value)

    def section(self, field: str) -> Fields:
        """A nested mapping; empty when the field is absent."""
        return Fields(self._get(field, {}), self._source, f"{self._prefix}{field}.")

    def sections(self, field: str, optional: bool = False) -> list[Fields]:
        """A list of mappings with at least one entry; none where `optional` and absent."""
        value = self._get(field, None if optional else _MISSING)
        if value is None:
            return []
        if not isinstance(value, list) or not value:
            raise self.error(field, f"a list of mappings expected, {_shown(value)} given")
        return [
            Fields(item, self._source, f"{self._prefix}{field}[{index}].")
            for index, item in enumerate(value)
        ]

    def done(self) -> None:
        """Refuse fields that no reader asked for."""
        unknown = [field for field in self._values if field not in self._known]
        if unknown:
            raise self.error(unknown[0], f"unknown field; known: {', '.join(self._known)}")

    def _get(self, field: str, default: Any) -> Any:
        self._known.append(field)
        value = self._values.get(field, default)
        if value is _MISSING:
            raise self.error(field, "missing")
        return value


def read_yaml(path: Path) -> Fields:
    """Fields of a YAML file.

    Raises:
        ConfigurationError: the file does not exist, is no YAML, or is no mapping.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from error
    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        problem = " ".join(str(error).split())
        raise ConfigurationError(f"{path}: not valid YAML: {problem}") from error
    return Fields(values, str(path))


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _is_point(value: object) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(map(_is_number, value))


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
