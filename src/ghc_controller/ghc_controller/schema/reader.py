"""Reads a YAML file field by field; every complaint names the file, the field and the remedy."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from ghc_controller.errors import ConfigurationError
from ghc_controller.migration.names import Kind, hint
from ghc_controller.schema.domains import Range, names_problem
from ghc_controller.schema.value_checks import is_number, shown, vector_problem

_MISSING: Any = object()
# The compiled one takes a tenth of the time; PyYAML may be built without it.
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
# What a tag or a number that is none raises: "2001-99-99", "!!bool x", "!!float ''".
_INVALID = (yaml.YAMLError, ValueError, LookupError, AttributeError)
_DEEPEST = 100  # [-] nested lists and mappings; the loader's stack would overflow with 20 000


class Fields:
    """One mapping of a configuration file; each reader marks its field as known.

    A reader without `default` makes the field required. A field without a value is rejected, and
    `done()` rejects what nobody read: neither a misspelt optional field nor an empty one is a
    silent default.
    """

    def __init__(self, values: object, source: str | Path, where: str = "") -> None:
        """Wrap `values`; `source` (the file) and `where` (dotted path) go into messages."""
        self._source = source
        self._where = where
        self._known: list[str] = []
        if not isinstance(values, Mapping):
            raise self.complaint(f"a mapping expected, {shown(values)} given")
        self._values: dict[str, Any] = {str(key): value for key, value in values.items()}

    def error(self, field: str, problem: str) -> ConfigurationError:
        """Error about one field, with the file and the full path of the field."""
        return ConfigurationError(f"{self._source}: {self._path(field)}: {problem}")

    def complaint(self, problem: str) -> ConfigurationError:
        """Error about the mapping as a whole."""
        where = f"{self._where}: " if self._where else ""
        return ConfigurationError(f"{self._source}: {where}{problem}")

    def given(self) -> tuple[str, ...]:
        """Names of all fields, in the order of the file."""
        return tuple(self._values)

    @property
    def values(self) -> dict[str, Any]:
        """The mapping as it stands in the file, nothing checked."""
        return dict(self._values)

    def has(self, field: str) -> bool:
        """Whether the field is given; marks it as known."""
        self._known.append(field)
        return field in self._values

    def value(self, field: str, default: Any = _MISSING) -> Any:
        """Whatever the field holds, for a reader of its own."""
        self._known.append(field)
        value = self._values.get(field, default)
        if value is _MISSING:
            raise self.error(field, f"missing; given: {', '.join(self._values) or 'nothing'}")
        if value is None and field in self._values:
            raise self.error(field, "it has no value: leave it out, or give one")
        return value

    def text(self, field: str, default: str = _MISSING) -> str:
        """A string that is not empty."""
        value = self.value(field, default)
        if not isinstance(value, str) or not value:
            raise self.error(field, f"a non-empty text expected, {shown(value)} given")
        return value

    def choice(self, field: str, known: Collection[str]) -> str:
        """One of the known names."""
        value = self.text(field)
        if value not in known:
            raise self.error(field, f"'{value}' given; known: {', '.join(known)}")
        return value

    def flag(self, field: str, default: bool = _MISSING) -> bool:
        """True or false."""
        value = self.value(field, default)
        if not isinstance(value, bool):
            raise self.error(field, f"true or false expected, {shown(value)} given")
        return value

    def number(self, field: str, default: float = _MISSING, minimum: float = -math.inf) -> float:
        """A finite number, at least `minimum`."""
        return self._number(field, self.value(field, default), minimum)

    def numbers(self, field: str, size: int | None) -> tuple[float, ...]:
        """`size` finite numbers; one number stands for `size` equal ones."""
        value = self.value(field)
        if is_number(value):
            return (float(value),) * (size or 1)
        return self._vector(field, value, size)

    def number_or_map(self, field: str) -> float | dict[str, float] | None:
        """One number, or a mapping name -> number; None when the field is absent."""
        value = self.value(field, None)
        if isinstance(value, Mapping):
            numbers = self.section(field)
            return {name: numbers.number(name) for name in numbers.given()}
        if value is not None and not is_number(value):
            expected = "a number or a mapping name: number"
            raise self.error(field, f"{expected} expected, {shown(value)} given")
        return None if value is None else float(value)

    def vector(
        self, field: str, size: int | None = None, default: Sequence[float] = _MISSING
    ) -> tuple[float, ...]:
        """Finite numbers; any number of them without `size`."""
        return self._vector(field, self.value(field, default), size)

    def vectors(
        self, field: str, size: int, default: Sequence[Sequence[float]] = _MISSING
    ) -> tuple[tuple[float, ...], ...]:
        """At least one vector of `size` finite numbers."""
        value = self.value(field, default)
        if not isinstance(value, (list, tuple)) or not value:
            raise self.error(
                field, f"a list of vectors of {size} numbers expected, {shown(value)} given"
            )
        return tuple(self._vector(f"{field}[{k}]", row, size) for k, row in enumerate(value))

    def names(
        self,
        field: str,
        known: Sequence[str] | None = None,
        default: Sequence[str] = _MISSING,
        optional: bool = False,
        of: str = "names",
    ) -> tuple[str, ...]:
        """Distinct names, out of `known` if given; none only where `optional`.

        `of` says in messages what is named.
        """
        value = self.value(field, () if optional else default)
        is_list = isinstance(value, (list, tuple)) and all(isinstance(x, str) for x in value)
        if not is_list or not (value or optional):
            raise self.error(field, f"a list of {of} expected, {shown(value)} given")
        problem = names_problem(value, known)
        if problem:
            raise self.error(field, problem)
        return tuple(value)

    def section(self, field: str, optional: bool = False) -> Fields:
        """A nested mapping; empty where `optional` and absent."""
        value = self.value(field, {} if optional else _MISSING)
        return Fields(value, self._source, self._path(field))

    def sections(
        self, field: str, optional: bool = False, size: int | None = None
    ) -> tuple[Fields, ...]:
        """A list of mappings: `size` of them, else at least one; none only where `optional`."""
        value = self.value(field, [] if optional else _MISSING)
        if not isinstance(value, list):
            raise self.error(field, f"a list of mappings expected, {shown(value)} given")
        if size is not None and len(value) != size:
            raise self.error(field, f"{size} entries expected, {len(value)} given")
        if not value and not optional:
            raise self.error(field, "at least one entry expected, none given")
        path = self._path(field)
        return tuple(Fields(item, self._source, f"{path}[{k}]") for k, item in enumerate(value))

    def done(self) -> None:
        """Reject fields that no reader asked for."""
        unknown = [field for field in self._values if field not in self._known]
        if unknown:
            words = hint(Kind.FIELD, unknown[0])
            if words:
                raise self.error(unknown[0], words)
            known = ", ".join(dict.fromkeys(self._known))
            raise self.error(unknown[0], f"unknown field; known: {known}")

    def _path(self, field: str) -> str:
        return f"{self._where}.{field}" if self._where else field

    def _number(self, field: str, value: Any, minimum: float = -math.inf) -> float:
        problem = Range(minimum).problem(value)
        if problem:
            raise self.error(field, problem)
        return float(value)

    def _vector(self, field: str, value: Any, size: int | None) -> tuple[float, ...]:
        problem = vector_problem(value, size)
        if problem:
            raise self.error(field, problem)
        return tuple(self._number(f"{field}[{k}]", item) for k, item in enumerate(value))


def read_yaml(path: Path) -> Fields:
    """Fields of a YAML file.

    Raises:
        ConfigurationError: the file cannot be read, is no YAML, or is no mapping.
    """
    text = ""
    try:
        text = path.read_text(encoding="utf-8")
        _check_depth(text)
        values = yaml.load(text, Loader=_LOADER)
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from error
    except _INVALID as error:
        raise ConfigurationError(f"{path}: not valid YAML: {_problem(error, text)}") from error
    return Fields(values, path)


def _problem(error: Exception, text: str) -> str:
    """An error of the loader in one line, with the line of the text that it is about."""
    told, lines = " ".join(str(error).split()), text.splitlines()
    mark = getattr(error, "problem_mark", None)
    if mark is None or mark.line >= len(lines):
        return told
    return f"{told}: {shown(lines[mark.line].strip())}"


def _check_depth(text: str) -> None:
    """Raise YAMLError if lists and mappings are nested too deeply for the loader."""
    depth = 0
    for event in yaml.parse(text, Loader=_LOADER):
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
            if depth > _DEEPEST:
                line = f", line {event.start_mark.line + 1}" if event.start_mark else ""
                raise yaml.YAMLError(f"at most {_DEEPEST} nested levels expected{line}")
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
