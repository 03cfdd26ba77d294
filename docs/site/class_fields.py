"""Fields of dataclasses, named tuples and enumerations, for the API: the sources say what they
are beside them, as a declaration or in a comment, and not in the docstring.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import is_dataclass
from enum import Enum
from typing import Any

_FIELD = re.compile(r"^    (\w+)(?:: ([^=#]+?))?(?: = (.*?))?(?:  # (.*))?$")
_COMMENT = re.compile(r"^    # (.*)$")


def described(kind: type) -> list[str]:
    """A section `Attributes` for a docstring; empty where the class has no such fields."""
    entries = dict(_commented(kind))
    if is_dataclass(kind):
        entries = {name: entries[name] for name in kind.__dataclass_fields__ if name in entries}
        entries |= {name: text for name, text in _declared(kind) if name in entries}
    elif hasattr(kind, "_fields"):
        entries = {name: entries[name] for name in kind._fields if name in entries}
    elif issubclass(kind, Enum):
        entries = {name: entries.get(name, "") for name in kind.__members__}
    else:
        return []
    return ["", "Attributes:", *(f"    {name}: {text}" for name, text in entries.items())]


def _commented(kind: type) -> Iterator[tuple[str, str]]:
    """Names of the class body with the comment beside or below them, or the value of a member."""
    name = text = ""
    for line in inspect.getsource(kind).splitlines():
        found, below = _FIELD.match(line), _COMMENT.match(line)
        if below and name:
            text = f"{text}; {below[1]}" if text else below[1]
            continue
        if name:
            yield name, text
        name, text = ("", "")
        if found and (found[2] or found[3]):
            value = "" if found[2] else f"`{found[3]}`"  # Sphinx writes types by itself
            name, text = found[1], found[4] or value
    if name:
        yield name, text


def _declared(kind: type) -> Iterator[tuple[str, str]]:
    """Names with unit, text and default of their declaration."""
    from ghc_controller.schema.declared import entries

    for entry in entries(kind):
        default = "" if entry.required else f"; default `{_shown(entry.default)}`"
        yield entry.field, entry.meaning + default


def _shown(default: Any) -> str:
    return default.name.lower() if isinstance(default, Enum) else repr(default)


def _process(_app: Any, kind: str, _name: str, obj: Any, _opts: Any, lines: list[str]) -> None:
    if kind == "class" and isinstance(obj, type) and "Attributes:" not in lines:
        lines += described(obj)


def _skip(_app: Any, _kind: str, _name: str, obj: Any, _now: bool, _opts: Any) -> bool | None:
    """Members of a named tuple have no text of their own."""
    return True if str(getattr(obj, "__doc__", "")).startswith("Alias for field") else None


def setup(app: Any) -> dict[str, bool]:
    """Connect with Sphinx, before docstrings are converted."""
    app.connect("autodoc-process-docstring", _process, priority=50)
    app.connect("autodoc-skip-member", _skip)
    return {"parallel_read_safe": True}
