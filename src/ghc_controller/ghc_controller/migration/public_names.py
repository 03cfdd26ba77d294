"""The public names of a package: each is imported at its first use, old ones say the new one."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from importlib import import_module

from ghc_controller.migration.names import Kind, hint


def load_name(package: str, homes: Mapping[str, str], name: str) -> object:
    """What `__getattr__` of a package returns whose names are in its modules `homes`.

    Raises:
        AttributeError: there is no such name; with the new one if it is of an earlier version.
    """
    if name not in homes:
        words = hint(Kind.NAME, name) if package == "ghc_controller" else ""
        reason = f"'{name}': {words}" if words else f"'{name}'"
        raise AttributeError(f"module '{package}' has no attribute {reason}")
    value = getattr(import_module(f"{package}.{homes[name]}"), name)
    vars(sys.modules[package])[name] = value  # the next use costs no look-up
    return value
