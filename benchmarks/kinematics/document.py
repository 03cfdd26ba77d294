"""Tables and figures of docs/gn_qn.md; the prose between them is written by hand."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from benchmarks.kinematics.figures import ERRORS, HAND, plot_errors, plot_hand
from benchmarks.kinematics.tables import ablation_table, check_table, humanoid_table, table_i

SOURCE = Path(__file__).resolve().parents[2] / "docs" / "gn_qn.md"
_TABLES = {
    "checks": check_table,
    "table_i": table_i,
    "ablation": ablation_table,
    "humanoid": humanoid_table,
}
_LONG = "T20/10000"


def write_document(results: Mapping[str, Any], folder: Path) -> None:
    """Write <folder>/gn_qn.md with the tables of these results, and figures/ beside it."""
    text = SOURCE.read_text(encoding="utf-8")
    for name, make in _TABLES.items():
        begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
        if begin not in text or end not in text:
            raise ValueError(f"{SOURCE}: no marks of table '{name}'")
        before, _, rest = text.partition(begin)
        text = f"{before}{begin}\n{make(results)}\n{end}{rest.partition(end)[2]}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "gn_qn.md").write_text(text, encoding="utf-8")
    if {"T1", "T2"} & set(results):
        plot_errors(results, folder / "figures" / ERRORS)
    if _LONG in results:
        plot_hand(results[_LONG], folder / "figures" / HAND)
