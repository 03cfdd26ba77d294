"""Tables of migration.md that are written from the sources: `python docs/migration_tables.py`."""

from __future__ import annotations

import re
from pathlib import Path

from ghc_controller.migration.messages import MESSAGES
from ghc_controller.migration.modules import FOLDERS, MODULES
from ghc_controller.migration.names import RENAMED

DOCUMENT = Path(__file__).resolve().parent / "migration.md"
_TABLE = re.compile(r"(<!-- table: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def names_table() -> str:
    """What a name is of, the old one, the new one."""
    lines = ["| | old | new |", "|---|---|---|"]
    lines += [f"| {row.kind.value} | `{row.old}` | `{row.new}` |" for row in RENAMED]
    return "\n".join(lines) + "\n"


def modules_table() -> str:
    """Old modules by the new one, in the order of their names."""
    lines = ["| old | what it held is in |", "|---|---|"]
    lines += [f"| `{old}` | `{new}` |" for old, new in sorted({**MODULES, **FOLDERS}.items())]
    return "\n".join(lines) + "\n"


def messages_table() -> str:
    """Old topics and fields, and the new ones."""
    lines = ["| old | new |", "|---|---|"]
    return "\n".join(lines + [f"| {old} | {new} |" for old, new in MESSAGES]) + "\n"


def rendered(text: str) -> str:
    """The document with all tables as the sources have them now."""
    tables = {"names": names_table, "modules": modules_table, "messages": messages_table}
    return _TABLE.sub(lambda match: f"{match[1]}\n{tables[match[2]]()}\n{match[3]}", text)


if __name__ == "__main__":
    DOCUMENT.write_text(rendered(DOCUMENT.read_text(encoding="utf-8")), encoding="utf-8")
