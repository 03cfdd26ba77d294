"""Tables of interfaces.md that are written from the sources: `python docs/interface_tables.py`.

Between `<!-- table: parameters controller -->` or `<!-- table: message TaskState -->` and the next
`<!-- end -->` stands what the dataclass or the .msg file says; a test compares the two.
"""

from __future__ import annotations

import re
from enum import Enum
from pathlib import Path

from ghc_controller.ros.parameters import ControllerParameters
from ghc_controller.ros.reachable.parameters import ReachableTargetsParameters
from ghc_controller.ros.shares.parameters import PriorityShareParameters
from ghc_controller.ros.steering.parameters import SteeringParameters
from ghc_controller.schema.declared import Entry, flat
from ghc_controller.schema.domains import OneOf
from ghc_mpc_constraints.ros.parameters import generator_parameters
from ghc_sim_bridge.parameters import (
    BridgeParameters,
    RecorderParameters,
    ReplayParameters,
    ViewerParameters,
)
from ghc_sim_bridge.ros.display.parameters import DisplayParameters

ROOT = Path(__file__).resolve().parents[1]
DOCUMENT = ROOT / "docs" / "interfaces.md"
MESSAGES = ROOT / "src" / "ghc_msgs" / "msg"
NODES: dict[str, type] = {
    "controller": ControllerParameters,
    "reachable_targets": ReachableTargetsParameters,
    "priority_share": PriorityShareParameters,
    "steering_page": SteeringParameters,
    "sim_bridge": BridgeParameters,
    "recorder": RecorderParameters,
    "replay": ReplayParameters,
    "viewer": ViewerParameters,
    "display_publisher": DisplayParameters,
    **{
        name: generator_parameters(name)
        for name in (
            "contact_forces",
            "obstacle_motion",
            "joint_limits",
            "torque_limits",
            "body_margins",
        )
    },
}
_TABLE = re.compile(r"(<!-- table: (\w+) (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)
_FIELD = re.compile(
    r"(?P<type>\S+)\s+(?P<name>\w+)(?:\s*=\s*(?P<value>\S+))?\s*(?:#\s*(?P<text>.*))?"
)
_TYPES = {str: "text", bool: "bool", float: "float", int: "int", tuple: "list of texts"}


def parameter_table(kind: type) -> str:
    """Name, type, default, range, unit and meaning of every field of a parameter dataclass."""
    lines = ["| parameter | type | default | range | meaning |", "|---|---|---|---|---|"]
    for entry in flat(kind):
        default = entry.default.value if isinstance(entry.default, Enum) else entry.default
        shown = "" if default in ("", ()) else f"`{str(default).lower()}`"
        lines.append(
            f"| `{entry.name}` | {_TYPES[type(default)]} | {shown} | {_range(entry)} "
            f"| {_cell(entry.meaning)} |"
        )
    return "\n".join(lines) + "\n"


def message_table(name: str) -> str:
    """Field, type and comment of every line of a .msg file."""
    lines = ["| field | type | meaning |", "|---|---|---|"]
    for line in (MESSAGES / f"{name}.msg").read_text(encoding="utf-8").splitlines():
        match = _FIELD.fullmatch(line.strip())
        if not line.strip() or line.startswith("#") or match is None:
            continue
        value = f" = {match['value']}" if match["value"] else ""
        text = _cell(match["text"] or "")
        lines.append(f"| `{match['name']}{value}` | `{match['type']}` | {text} |")
    return "\n".join(lines) + "\n"


def rendered(text: str) -> str:
    """The document with every table as the sources have it now."""

    def table(match: re.Match[str]) -> str:
        source, name = match[2], match[3]
        content = parameter_table(NODES[name]) if source == "parameters" else message_table(name)
        return f"{match[1]}\n{content}\n{match[4]}"

    return _TABLE.sub(table, text)


def tables(text: str) -> set[tuple[str, str]]:
    """(source, name) of every table of the document."""
    return {(match[2], match[3]) for match in _TABLE.finditer(text)}


def _range(entry: Entry) -> str:
    if isinstance(entry.default, Enum):
        return OneOf(tuple(kind.value for kind in type(entry.default))).words
    domain = entry.declaration.domain
    return "" if domain is None else domain.words


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")


if __name__ == "__main__":
    DOCUMENT.write_text(rendered(DOCUMENT.read_text(encoding="utf-8")), encoding="utf-8")
