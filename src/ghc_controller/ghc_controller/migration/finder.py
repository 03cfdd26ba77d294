"""Importing a module of an earlier version fails with the new name of what it held."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from types import ModuleType

from ghc_controller.migration.names import Kind, hint

_PACKAGES = ("ghc_controller", "ghc_mpc_constraints", "ghc_sim_bridge")


class OldModules(MetaPathFinder):
    """Asked last, when no module was found; finds none itself."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> None:
        """Say where an old name has gone.

        Raises:
            ModuleNotFoundError: it is the name of an earlier version.
        """
        del path, target
        if fullname.partition(".")[0] in _PACKAGES:
            reason = moved(fullname)
            if reason:
                raise ModuleNotFoundError(reason)


def moved(fullname: str) -> str:
    """What to say of a dotted name that does not exist; empty if it never did."""
    from ghc_controller.migration.modules import FOLDERS, MODULES  # not before it is needed

    parent, _, name = fullname.rpartition(".")
    if fullname in MODULES:
        return f"no module '{fullname}': what it held is in {MODULES[fullname]} now"
    if parent in FOLDERS and not name.startswith("__"):
        return f"cannot import '{name}' from '{parent}': see {FOLDERS[parent]}"
    words = hint(Kind.NAME, name) if parent == "ghc_controller" else ""
    return f"cannot import '{name}' from '{parent}': {words}" if words else ""


def install() -> None:
    """Ask this finder after all others; once per process."""
    if not any(isinstance(finder, OldModules) for finder in sys.meta_path):
        sys.meta_path.append(OldModules())
