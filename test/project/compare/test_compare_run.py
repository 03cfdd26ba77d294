"""`make compare` in small: results, resuming, rejections, and the same on a dask cluster."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks.compare.cases import CASES
from benchmarks.compare.jobs import Job, run_job
from benchmarks.compare.method import METHODS
from benchmarks.compare.pages.page import missing, page
from benchmarks.compare.run import main
from benchmarks.compare.store import is_done, load, path_of
from benchmarks.models import install_cluster, install_model

ROOT = Path(__file__).resolve().parents[3]
STORED = ROOT / "docs" / "comparison"


def run(folder: Path, *arguments: str) -> int:
    return main(["--quick", "--output", str(folder), *arguments])


def stored(folder: Path) -> dict[str, Any]:
    files = sorted(folder.glob("*/*.json"))
    return {f"{file.parent.name}/{file.stem}": json.loads(file.read_text()) for file in files}


@pytest.mark.parametrize("name", CASES)
def test_every_case_has_errors_by_level_and_costs(name: str) -> None:
    install_model("icub-models")
    result: Any = run_job(Job(name, "cascade", quick=True))
    json.dumps(result, allow_nan=False)
    tasks = result["phases"][0]["tasks"]
    assert {task["level"] for task in tasks} == set(range(1, 1 + max(t["level"] for t in tasks)))
    assert all(task["end"] <= task["max"] for task in tasks)
    assert result["operations"] > 0.0
    assert result["steps"] > 0
    assert result["unsolved"] == 0


@pytest.mark.parametrize("method", METHODS)
def test_every_formulation_runs_or_says_why_not(method: str) -> None:
    result: Any = run_job(Job("nonstrict", method, quick=True))
    if "rejected" in result:
        assert "knows orders only" in result["rejected"]
    assert ("rejected" in result) == (method not in _TAKES_MATRICES)


_TAKES_MATRICES = ("cascade", "ghc", "ghc_full", "balanced", "weighted", "hqp")


def test_what_is_done_is_not_run_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "comparison"
    chosen = ("--case", "unreachable", "--formulation", "ghc", "--workers", "1")
    assert run(folder, *chosen) == 0
    assert "0 of 1 are done" in capsys.readouterr().err
    job = Job("unreachable", "ghc", quick=True)
    assert is_done(folder, job)
    assert not is_done(folder, job._replace(quick=False))
    before = path_of(folder, job).stat().st_mtime_ns
    assert run(folder, *chosen) == 0
    assert "1 of 1 are done" in capsys.readouterr().err
    assert path_of(folder, job).stat().st_mtime_ns == before
    result = json.loads(path_of(folder, job).read_text(encoding="utf-8"))
    older = json.dumps(result | {"sources": "older"})
    path_of(folder, job).write_text(older, encoding="utf-8")
    assert "All 1 results shown are of older code" in missing(load(folder))
    assert run(folder, *chosen) == 0
    assert json.loads(path_of(folder, job).read_text(encoding="utf-8")) == result
    text = folder.with_suffix(".md").read_text(encoding="utf-8")
    assert "231 of 232 results are missing" in text
    assert (tmp_path / "figures" / "comparison.png").stat().st_size > 5_000


@pytest.mark.timeout(600)
def test_a_dask_cluster_gives_the_same_results(tmp_path: Path) -> None:
    install_cluster()
    from distributed import LocalCluster

    chosen = ("--case", "fencing_near_bounds", "--formulation", "cascade", "--formulation", "hqp")
    assert run(tmp_path / "here", *chosen, "--workers", "1") == 0
    with LocalCluster(
        n_workers=1, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
    ) as cluster:
        assert run(tmp_path / "there", *chosen, "--cluster", cluster.scheduler_address) == 0
    assert set(stored(tmp_path / "here")) == {
        "fencing_near_bounds/cascade",
        "fencing_near_bounds/hqp",
    }
    assert stored(tmp_path / "here") == stored(tmp_path / "there")


def test_unknown_names_and_a_cluster_that_is_not_there_are_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        run(tmp_path / "c", "--case", "no_such_case")
    assert "no_such_case" in capsys.readouterr().err


def test_the_committed_page_is_that_of_the_committed_results() -> None:
    results = load(STORED)
    text = (ROOT / "docs" / "comparison.md").read_text(encoding="utf-8")
    assert "<!--" not in text
    assert set(results) <= set(CASES)
    for case in results:
        assert CASES[case].title in text
    for file in STORED.glob("*/*.json"):
        assert file.stat().st_size < 8_000
    # The line on results of older code follows the sources; all else is that of the results.
    assert _without_first_paragraph(text) == _without_first_paragraph(page(results))


def _without_first_paragraph(text: str) -> str:
    return text.split("\n\n", 2)[2]
