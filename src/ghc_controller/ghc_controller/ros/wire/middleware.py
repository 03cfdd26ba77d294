"""Which DDS is used: checked before rclpy is loaded, which ends the process without a reason."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

_CHOICE = "RMW_IMPLEMENTATION"
_INDEX = Path("share", "ament_index", "resource_index", "rmw_typesupport")
_SWITCH = "rmw_implementation"  # the library that loads one of the others


def complaint(environment: Mapping[str, str] = os.environ) -> str:
    """What is wrong with RMW_IMPLEMENTATION; "" if it is installed, or cannot be judged."""
    chosen = environment.get(_CHOICE, "")
    prefixes = filter(None, environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep))
    installed = {entry.name for prefix in prefixes for entry in Path(prefix, _INDEX).glob("*")}
    installed.discard(_SWITCH)
    if not chosen or not installed or chosen in installed:
        return ""
    return (
        f"{_CHOICE}: '{chosen}' given, an installed one expected; installed: "
        f"{', '.join(sorted(installed))}; `unset {_CHOICE}` takes the default"
    )


def refuse_missing() -> None:
    """End the process with one line if the chosen middleware is not installed."""
    words = complaint()
    if words:
        raise SystemExit(words)
