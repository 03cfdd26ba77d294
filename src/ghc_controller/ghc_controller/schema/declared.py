"""Declarations of settings: a dataclass whose fields say unit, range and meaning beside them.

```python
@dataclass(frozen=True, slots=True)
class Camera:
    distance: float = declared("from the point looked at", unit="m", domain=Range(minimum=0.01))
    field_of_view: float = declared("vertical", 35.0, unit="deg", domain=Range(minimum=1.0))
```

From it `record.py` reads YAML files, mappings written in Python and ROS parameters, and
`json_schema.py` writes what an editor needs. A field that is read from no file has no declaration.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, field, fields
from typing import Any, get_type_hints
from weakref import WeakKeyDictionary

from ghc_controller.errors import InvalidField
from ghc_controller.schema.domains import Domain, Range

_KEY = "declared"
_INLINE = "inline"
_CHOSEN = "chosen"
NO_FALLBACK = object()
_HINTS: WeakKeyDictionary[type, Mapping[str, Any]] = WeakKeyDictionary()


@dataclass(frozen=True, slots=True)
class Declaration:
    """What stands beside a field."""

    text: str
    unit: str = ""
    domain: Domain | None = None
    name: str = ""  # in files and parameters; empty = that of the field
    names: str = ""  # kind of name it refers to, such as "frame": checked where these are known
    of: str = "names"  # what a list of names is of, in messages
    per_row: bool = False  # one number, or one for each row of a task
    fallback: Any = NO_FALLBACK  # where a file leaves it out, though Python has to say it
    empty: bool = True  # whether an optional list or text may be empty
    size: int | None = None  # entries that a list must have
    later: type | None = None  # of a section that is handed on as Fields, to be read later
    read: Callable[[Any, str], Any] | None = None  # (fields, name) -> value: a reader of its own
    schema: Callable[[Any], dict[str, Any]] | None = None  # of a value with its own reader


@dataclass(frozen=True, slots=True)
class Entry:
    """A field of a declared dataclass."""

    field: str
    name: str
    kind: Any  # its type
    default: Any  # MISSING where it is required
    declaration: Declaration

    @property
    def required(self) -> bool:
        """Whether it has to be given."""
        return self.default is MISSING

    @property
    def meaning(self) -> str:
        """Unit and text, as tables show them."""
        unit = f"[{self.declaration.unit}] " if self.declaration.unit else ""
        return unit + self.declaration.text


@dataclass(frozen=True, slots=True)
class Choice:
    """How the value of one field chooses the dataclass of another."""

    field: str
    find: Callable[[str], type | None]


def declared(text: str, default: Any = MISSING, **about: Any) -> Any:
    """A dataclass field with its declaration; without a default it has to be given.

    Args:
        text: what it means, without its unit.
        default: a mutable one is a function that makes it.
        about: unit, domain and the other fields of `Declaration`.
    """
    metadata = {_KEY: Declaration(text, **about)}
    if callable(default):
        return field(default_factory=default, metadata=metadata)
    return field(default=default, metadata=metadata)


def inline(kind: type) -> Any:
    """A dataclass field whose own fields stand beside those of the dataclass that has it."""
    return field(default_factory=kind, metadata={_INLINE: True})


def chosen_by(name: str, find: Callable[[str], type | None]) -> Any:
    """A dataclass field with a record of the kind that the value of the field `name` chooses.

    Its fields stand beside those of the dataclass that has it. None: that value has none.
    """
    return field(default=None, metadata={_CHOSEN: Choice(name, find)})


def entries(kind: type) -> tuple[Entry, ...]:
    """Declared fields of one dataclass, those of inline ones left out."""
    hints = _hints(kind)
    found = []
    for item in fields(kind):
        if _KEY in item.metadata:
            declaration = item.metadata[_KEY]
            found.append(
                Entry(
                    item.name,
                    declaration.name or item.name,
                    hints[item.name],
                    _default(item),
                    declaration,
                )
            )
    return tuple(found)


def inlined(kind: type) -> dict[str, type]:
    """Field -> dataclass of the inline fields of a dataclass."""
    hints = _hints(kind)
    return {item.name: hints[item.name] for item in fields(kind) if _INLINE in item.metadata}


def chosen(kind: type) -> dict[str, Choice]:
    """Field -> what chooses its dataclass."""
    return {item.name: item.metadata[_CHOSEN] for item in fields(kind) if _CHOSEN in item.metadata}


def flat(kind: type) -> Iterator[Entry]:
    """Declared fields of a dataclass and of what stands inline in it, by their names in files."""
    own = {entry.field: entry for entry in entries(kind)}
    parts = inlined(kind)
    for item in fields(kind):
        if item.name in own:
            yield own[item.name]
        elif item.name in parts:
            yield from flat(parts[item.name])


def flat_values(record: Any) -> Iterator[tuple[Entry, Any]]:
    """Declared fields of a record with their values, inline and chosen ones included."""
    for entry in entries(type(record)):
        yield entry, getattr(record, entry.field)
    for name in inlined(type(record)):
        yield from flat_values(getattr(record, name))
    for name in chosen(type(record)):
        if getattr(record, name) is not None:
            yield from flat_values(getattr(record, name))


def check(record: Any) -> None:
    """Hold a record that was made in Python against the declarations of its numbers and texts.

    Raises:
        InvalidField: the first field outside its domain, with what was given and expected.
    """
    for entry in entries(type(record)):
        domain, value = entry.declaration.domain, getattr(record, entry.field)
        if domain is None or value is None or _is_many(value, domain):
            continue
        problem = domain.problem(value)
        if problem:
            raise InvalidField(entry.name, problem)


def _hints(kind: type) -> Mapping[str, Any]:
    """Field -> type of a dataclass; evaluating annotations is most of the time of a reader."""
    found = _HINTS.get(kind)
    if found is None:
        found = _HINTS[kind] = get_type_hints(kind)
    return found


def _is_many(value: Any, domain: Domain) -> bool:
    """Numbers of a list are checked where they are read."""
    return isinstance(domain, Range) and isinstance(value, Sequence)


def _default(item: Field[Any]) -> Any:
    declaration: Declaration = item.metadata[_KEY]
    if declaration.fallback is not NO_FALLBACK:
        return declaration.fallback
    if item.default_factory is not MISSING:
        return item.default_factory()
    return item.default
