"""Reports are JSON also where a number is not finite."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from ghc_controller.report.valid_json import json_text

ROOT = Path(__file__).parents[3]


def _strict(text: str) -> Any:
    def refuse(name: str) -> float:
        raise ValueError(f"{name} is no JSON")

    return json.loads(text, parse_constant=refuse)


def test_what_is_not_finite_becomes_null() -> None:
    data = {"a": [1.0, np.nan, (np.inf, {"b": -np.inf})], "c": np.float64(np.nan), "d": "NaN"}
    expected = {"a": [1.0, None, [None, {"b": None}]], "c": None, "d": "NaN"}
    assert _strict(json_text(data)) == expected


def test_finite_data_are_written_as_by_json() -> None:
    data = {"a": [1, 0.1, True, None, "x"], "b": {"c": np.float64(1e-300)}, 3: ()}
    assert json_text(data) == json.dumps(data)
    assert json_text(data, 1) == json.dumps(data, indent=1)


def test_every_report_file_is_written_that_way() -> None:
    """No module writes a file of the JSON writer that lets NaN through."""
    wrong = []
    for folder in ("src", "benchmarks", "tools"):
        for path in (ROOT / folder).rglob("*.py"):
            text = path.read_text(encoding="utf-8")
            for call in re.finditer(r"write_text\(\s*json\.dumps\(", text):
                if "allow_nan=False" not in text[call.end() :].split("encoding", 1)[0]:
                    wrong.append(f"{path.relative_to(ROOT)}")
    assert set(wrong) <= {"benchmarks/loops/ping_pong.py", "tools/docs.py"}  # counts and names
