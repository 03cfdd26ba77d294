"""The soak runs, its growth is what it says, and its section survives the benchmark's document."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from benchmarks.soak.inputs import DRIVERS
from benchmarks.soak.memory import GROWTH_GOAL, MemoryCourse, resident_memory
from benchmarks.soak.report import FIGURE, soak_table, write_soak_section
from benchmarks.soak.run import main
from benchmarks.soak.section import GENERATORS
from ghc_controller.errors import GhcError

pytestmark = pytest.mark.timeout(300)  # [s]

DOCUMENT = "# Time\n\nText.\n\n## What to keep in mind\n\n- Much.\n"


def _course(growth: float, warm_up: float = 60.0) -> MemoryCourse:
    """100 MB before the end of the warm-up, 200 MB after, then `growth` [MB] evenly to the end."""
    times = np.arange(601.0)
    resident = np.where(times < 60.0, 100.0, 200.0 + growth * (times - 60.0) / 540.0)
    return MemoryCourse("node", tuple(times), tuple(resident), warm_up, 60_001, 4)


@pytest.mark.parametrize("growth", [-5.0, 0.0, 1.0, 3.0])
def test_growth_leaves_the_warm_up_out(growth: float) -> None:
    """95 % of an even growth: the medians stand in the middle of 5 % at both ends."""
    course = _course(growth)
    assert course.growth() == pytest.approx(0.95 * growth, abs=0.01 * abs(growth))
    assert course.summary()["met"] == (growth < GROWTH_GOAL)
    assert _course(growth, warm_up=0.0).growth() > 90.0


def test_growth_is_not_that_of_one_sample() -> None:
    course = _course(0.0)
    spiky = [*course.resident[:-1], 300.0]
    again = MemoryCourse("node", course.times, spiky, 60.0, 1, 1)
    assert again.growth() == 0.0
    assert again.summary()["peak_mb"] == 300.0


def test_a_run_that_ends_in_its_warm_up_is_refused() -> None:
    with pytest.raises(GhcError, match=r"no sample after 700 s of warm-up"):
        _course(0.0, warm_up=700.0).growth()


def test_memory_of_a_process_is_read_and_of_none_is_an_error() -> None:
    assert 10.0 < resident_memory(os.getpid()) < 10_000.0
    with pytest.raises(GhcError, match="no resident memory to be read"):
        resident_memory(2**22 + 1)


def test_both_nodes_answer_and_results_are_complete(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Three simulated seconds; how much memory they take is not judged here."""
    assert main(["--quick", "--output", str(tmp_path)]) in (0, 1)
    results = json.loads((tmp_path / "soak.json").read_text(encoding="utf-8"))
    assert [row["node"] for row in results["nodes"]] == [driver.generator for driver in DRIVERS]
    for row in results["nodes"]:
        assert row["plans"] == 301
        assert row["handled"] == 4
        course = results["courses"][row["node"]]
        assert len(course["time_s"]) == len(course["resident_mb"]) == 31
    assert soak_table(results["nodes"]) in capsys.readouterr().out
    assert 3_000 < (tmp_path / FIGURE).stat().st_size < 100_000
    document = tmp_path / "benchmarks.md"
    document.write_text(DOCUMENT, encoding="utf-8")
    write_soak_section(results, document)
    text = document.read_text(encoding="utf-8")
    assert soak_table(results["nodes"]) in text
    assert "short run" in text
    assert "{" not in text


def test_the_section_is_replaced_and_kept_by_the_other_program() -> None:
    first = GENERATORS.put(DOCUMENT, "## Memory\n\none")
    assert first.index("one") < first.index("## What to keep in mind")
    second = GENERATORS.put(first, "## Memory\n\ntwo \\1")
    assert second == first.replace("one", "two \\1")
    assert GENERATORS.keep(DOCUMENT, second) == second
    assert GENERATORS.keep(DOCUMENT, "") == DOCUMENT
    assert GENERATORS.put("", "body").count("body") == 1
