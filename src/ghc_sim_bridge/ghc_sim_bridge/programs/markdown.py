"""Markdown helpers: tables, numbers, figures."""

from __future__ import annotations

from collections.abc import Sequence


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; the first column is left-aligned, the others are right-aligned."""
    marks = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, marks, *rows])


def picture(file: str, caption: str) -> str:
    """A figure of docs/figures with its caption below."""
    return f"![{caption}](figures/{file})\n\n*{caption}*"


def number(value: float | None, digits: int = 2) -> str:
    """A number with few significant digits; a dash for None."""
    if value is None:
        return "–"
    if value == 0.0:
        return "0"
    if 1e-2 <= abs(value) < 1e5:
        return f"{value:.{digits}g}" if abs(value) < 10**digits else f"{value:.0f}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa}e{int(exponent)}"
