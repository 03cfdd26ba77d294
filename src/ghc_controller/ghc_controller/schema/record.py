"""The one reader of declared dataclasses: from YAML files, from Python and from ROS parameters.

All three come as `Fields`, a mapping that knows how to name its fields in a message; the
declarations (`declared.py`) say the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import is_dataclass
from enum import Enum
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin

from ghc_controller.errors import InvalidField, InvalidValue
from ghc_controller.schema.declared import Declaration, Entry, chosen, entries, inlined
from ghc_controller.schema.domains import Range
from ghc_controller.schema.reader import Fields

T = TypeVar("T")
Names = Mapping[str, Sequence[str]]  # kind of name, such as "frame" -> those that exist
Rows = Callable[[Mapping[str, Any]], int]  # values read so far -> rows of a task
_NONE_KNOWN: Names = {}


def read(
    fields: Fields,
    kind: type[T],
    *,
    names: Names = _NONE_KNOWN,
    rows: Rows | None = None,
    base: T | None = None,
) -> T:
    """A record of `kind` from a mapping that holds nothing else.

    Args:
        names: where they are known, references to names of these kinds are checked.
        rows: how many numbers a field `per_row` has.
        base: what holds for fields that are not given, instead of the defaults.

    Raises:
        ConfigurationError: a field is missing, unknown, of another type or outside its domain;
            the message says where, what was given and what was expected.
    """
    record = _record(fields, kind, names, rows, base)
    fields.done()
    return record


def known_names(kind: type, given: Mapping[str, Any], base: Any = None) -> Iterator[str]:
    """Names that a mapping may have, those of records that its values choose included."""
    for entry in entries(kind):
        yield entry.name
    for name, part in inlined(kind).items():
        yield from known_names(part, given, None if base is None else getattr(base, name))
    by_field = {entry.field: entry for entry in entries(kind)}
    for choice in chosen(kind).values():
        entry = by_field[choice.field]
        usual = entry.default if base is None else getattr(base, entry.field)
        own = choice.find(given.get(entry.name, usual))
        if own is not None:
            yield from known_names(own, given)


def from_mapping(
    kind: type[T], values: Mapping[str, Any], source: str, base: T | None = None
) -> T:
    """A record from a mapping written in Python; `source` names it in messages. Raises as read."""
    return read(Fields(values, source), kind, base=base)


def _record(fields: Fields, kind: type[T], names: Names, rows: Rows | None, base: T | None) -> T:
    reader = _Reader(fields, names)
    values: dict[str, Any] = {}
    late = []
    for entry in entries(kind):
        if entry.declaration.per_row:
            late.append(entry)
        else:
            values[entry.field] = reader.value(entry, base)
    count = rows(values) if rows is not None and late else None
    for entry in late:
        if entry.required or fields.has(entry.name):
            values[entry.field] = fields.numbers(entry.name, count)
        else:
            values[entry.field] = entry.default
    for name, part in inlined(kind).items():
        below = None if base is None else getattr(base, name)
        values[name] = _record(fields, part, names, rows, below)
    for name, choice in chosen(kind).items():
        own = choice.find(values[choice.field])
        below = getattr(base, name) if own and isinstance(getattr(base, name, None), own) else None
        values[name] = None if own is None else _record(fields, own, names, rows, below)
    try:
        return kind(**values)
    except InvalidField as error:
        raise fields.error(error.field, error.problem) from error
    except InvalidValue as error:
        raise fields.complaint(str(error)) from error


class _Reader:
    """Reads fields by their types."""

    def __init__(self, fields: Fields, names: Names) -> None:
        self._fields = fields
        self._names = names

    def value(self, entry: Entry, base: Any) -> Any:
        """What is given, else the value of `base` or the default."""
        declaration, name = entry.declaration, entry.name
        if declaration.read is not None:
            return declaration.read(self._fields, name)
        if not entry.required and not self._fields.has(name):
            return entry.default if base is None else getattr(base, entry.field)
        kinds = kinds_of(entry.kind)
        if declaration.later is not None:
            many = get_origin(kinds[0]) is tuple
            optional = not entry.required
            return self._fields.sections(name, optional) if many else self._fields.section(name)
        if len(kinds) > 1:  # float | Mapping[str, float]
            return self._fields.number_or_map(name)
        return self._one(entry, kinds[0])

    def _one(self, entry: Entry, kind: Any) -> Any:
        fields, name, declaration = self._fields, entry.name, entry.declaration
        if kind is bool:
            return fields.flag(name)
        if kind in (int, float):
            return self._number(name, kind, declaration)
        if kind is str:
            return self._text(entry)
        if isinstance(kind, type) and issubclass(kind, Enum):
            return kind(fields.choice(name, [item.value for item in kind]))
        if is_dataclass(kind):
            return read(fields.section(name), kind, names=self._names)  # type: ignore[arg-type]
        if get_origin(kind) is tuple:
            return self._list(name, get_args(kind), declaration)
        return self._mapping(name, get_args(kind)[1])

    def _number(self, name: str, kind: type, declaration: Declaration) -> float:
        domain = declaration.domain or Range()
        value = self._fields.value(name)
        problem = domain.problem(value)
        if problem:
            raise self._fields.error(name, problem)
        if kind is float:
            return float(value)
        if value != int(value):
            raise self._fields.error(name, f"a whole number expected, {value:g} given")
        return int(value)

    def _text(self, entry: Entry) -> str:
        fields, name, declaration = self._fields, entry.name, entry.declaration
        value = fields.value(name)
        optional = value == "" and entry.default == ""
        if declaration.domain is not None and isinstance(value, str):
            self._within(name, value, declaration)
        text = "" if optional else fields.text(name)
        if declaration.names in self._names:
            return fields.choice(name, self._names[declaration.names])
        return text

    def _list(self, name: str, kinds: tuple[Any, ...], declaration: Declaration) -> Any:
        item, fields = kinds[0], self._fields
        size = declaration.size or (None if kinds[-1] is Ellipsis else len(kinds))
        if item is str:
            known = self._names.get(declaration.names)
            values = fields.names(name, known, optional=declaration.empty, of=declaration.of)
            self._within(name, values, declaration)
            return values
        if item is float:
            return self._numbers(name, fields.vector(name, size), declaration)
        if get_origin(item) is tuple:
            return fields.vectors(name, len(get_args(item)))
        sections = fields.sections(name, optional=declaration.empty and size is None, size=size)
        return tuple(read(section, item, names=self._names) for section in sections)

    def _numbers(
        self, name: str, values: tuple[float, ...], declaration: Declaration
    ) -> tuple[float, ...]:
        for k, value in enumerate(values):
            self._within(f"{name}[{k}]", value, declaration)
        return values

    def _mapping(self, name: str, kind: Any) -> dict[str, Any]:
        section = self._fields.section(name)
        if kind is float:
            return {key: section.number(key) for key in section.given()}
        if is_dataclass(kind):
            return {
                key: read(section.section(key), kind, names=self._names)  # type: ignore[arg-type]
                for key in section.given()
            }
        return section.values

    def _within(self, name: str, value: Any, declaration: Declaration) -> None:
        problem = declaration.domain.problem(value) if declaration.domain is not None else ""
        if problem:
            raise self._fields.error(name, problem)


def kinds_of(kind: Any) -> tuple[Any, ...]:
    """The types that a field may have, None left out."""
    if get_origin(kind) in (Union, UnionType):
        return tuple(part for part in get_args(kind) if part is not NoneType)
    return (kind,)
