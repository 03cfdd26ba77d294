"""Methods of earlier versions: calling one raises an error that gives the new name."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from ghc_controller.migration.names import Kind, hint


class OldMethods:
    """Base of classes that have lost a method; nothing changes for those that they have."""

    if not TYPE_CHECKING:  # or every name would exist to a type checker

        def __getattr__(self, name: str) -> NoReturn:
            """AttributeError, with the new name for a method of an earlier version."""
            owner = type(self).__name__
            words = hint(Kind.METHOD, f"{owner}.{name}")
            reason = f"'{name}': {words}" if words else f"'{name}'"
            raise AttributeError(f"'{owner}' object has no attribute {reason}")
