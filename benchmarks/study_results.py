"""Small, stable results of studies: rounded, merged by formulation, and the document from them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.code_version import commit, other_code, sources
from benchmarks.studies import Study, StudyWithFigure, StudyWithPage
from ghc_controller.types import Array
from ghc_sim_bridge.programs.markdown import picture

_DIGITS = 4  # significant
_INTRODUCTION = """# Studies

Written by `make study`, from the results in docs/study. Problem sets on which the claims of the
formulations are tested: active bounds, many tasks, ramps, conflicts, limits under motion. Seeds
and sizes stand in the results; a formulation can be run alone with
`make study ARGS="<name> --formulation <formulation>"`. The torque rate limit is off unless a
section says otherwise; all other settings are defaults unless a section says otherwise. CPU times
are those of one thread on a shared machine: orders of magnitude, no benchmark.
"""


def store(folder: Path, name: str, result: Mapping[str, Any]) -> dict[str, Any]:
    """Write a result to <folder>/<name>.json and return the merged content.

    Formulations that were not run are kept from the file, provided that its facts (sizes, seeds)
    and the sources of the controller are the same; otherwise the file is replaced.
    """
    path = folder / f"{name}.json"
    new = rounded(result) | {"sources": sources(), "commit": commit()}
    if path.exists():
        old = json.loads(path.read_text(encoding="utf-8"))
        if all(old.get(part) == new[part] for part in ("facts", "sources")):
            new["formulations"] = old["formulations"] | new["formulations"]
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(new, indent=1, sort_keys=True, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")
    return json.loads(text)


def rounded(value: Any) -> Any:
    """JSON values with floats of four significant digits; None for values that are not finite."""
    if isinstance(value, Mapping):
        return {str(key): rounded(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(entry) for entry in value]
    if isinstance(value, float | np.floating):
        number = float(value)
        return float(f"{number:.{_DIGITS - 1}e}") if math.isfinite(number) else None
    if isinstance(value, np.integer):
        return int(value)
    return value


def spread(values: Sequence[float] | Array) -> dict[str, float]:
    """Median, 95th percentile and maximum; not a number without values."""
    if not len(values):
        return dict.fromkeys(("median", "p95", "max"), math.nan)
    array = np.asarray(values, dtype=float)
    return {
        "median": float(np.median(array)),
        "p95": float(np.percentile(array, 95.0)),
        "max": float(array.max()),
    }


def shown(value: float | None, form: str = ".3g") -> str:
    """A cell of a table: the number, or a dash where there is none."""
    return "-" if value is None else format(value, form)


def shown_spread(values: Mapping[str, float | None]) -> str:
    """Median / p95 / max in one cell."""
    return " / ".join(shown(values[key]) for key in ("median", "p95", "max"))


def write_document(folder: Path, studies: Mapping[str, Study]) -> None:
    """Write <folder>.md from the results in the folder; nothing without results.

    Figures go to figures/ beside it, pages of studies that have one beside it too.
    """
    files = {name: folder / f"{name}.json" for name in studies}
    results = {
        name: json.loads(path.read_text(encoding="utf-8"))
        for name, path in files.items()
        if path.exists()
    }
    if not results:
        return
    parts = [_INTRODUCTION]
    if sentence := other_code(results):
        parts.append(sentence + "\n")
    for name, result in results.items():
        study = studies[name]
        parts.append(f"## {study.TITLE}\n\n`{name}`. {study.table(result)}\n")
        if isinstance(study, StudyWithFigure):
            study.plot(result, folder.parent / "figures" / study.FIGURE)
            parts.append(picture(study.FIGURE, study.CAPTION) + "\n")
        if isinstance(study, StudyWithPage):
            target = folder.parent / study.PAGE
            target.write_text(study.page(result), encoding="utf-8")
    folder.with_suffix(".md").write_text("\n".join(parts), encoding="utf-8")
