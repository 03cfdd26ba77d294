"""What to say of a module that is not found, if an earlier version had it."""

from __future__ import annotations

from ghc_controller.migration.modules import FOLDERS, MODULES
from ghc_controller.migration.names import Kind, hint


def raise_if_moved(fullname: str) -> None:
    """Return for a dotted name that never was.

    Raises:
        ModuleNotFoundError: it is the name of an earlier version; says the new one.
    """
    reason = _reason(fullname)
    if reason:
        raise ModuleNotFoundError(reason)


def _reason(fullname: str) -> str:
    inside = [old for old in MODULES if old.startswith(f"{fullname}.")]
    if inside and fullname not in MODULES and fullname not in FOLDERS:  # a folder that has gone
        return "; ".join(f"what {old} held is in {MODULES[old]} now" for old in inside)
    parent, _, name = fullname.rpartition(".")
    if fullname in MODULES:
        return f"no module '{fullname}': what it held is in {MODULES[fullname]} now"
    if parent in FOLDERS and not name.startswith("__"):
        return f"cannot import '{name}' from '{parent}': see {FOLDERS[parent]}"
    words = hint(Kind.NAME, name) if parent == "ghc_controller" else ""
    return f"cannot import '{name}' from '{parent}': {words}" if words else ""
