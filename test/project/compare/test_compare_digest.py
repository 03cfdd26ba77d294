"""A digest follows the imports of case and formulation, and nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

import ghc_controller
from benchmarks.code_version import sources
from benchmarks.compare import digest as module
from benchmarks.compare.digest import digest, sources_of
from benchmarks.compare.jobs import Job, all_jobs, job_digest

FORMULATIONS = "ghc_controller.formulations"
CASE = "benchmarks.compare.runs.scenario_loop"


def forget() -> None:
    """Files and imports are found once per process; a test that moves them finds them anew."""
    for found in (module._file_of, module._imports, module._common_files):
        found.cache_clear()


@pytest.fixture(autouse=True)
def _real_sources(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """What a test found in folders of its own is no source of the tests behind it."""
    yield
    monkeypatch.undo()
    forget()


def files(*modules: str) -> set[str]:
    """Paths below the package, such as formulations/hqp.py."""
    return {"/".join(path.parts[-2:]) for path in sources_of(modules)}


def test_a_formulation_depends_on_those_that_it_imports_alone() -> None:
    ghc = files(CASE, f"{FORMULATIONS}.ghc")
    assert {"formulations/ghc.py", "runs/closed_loop.py", "simulation/simulator.py"} <= ghc
    assert not {"formulations/balanced.py", "cascade/cascade.py", "formulations/hqp.py"} & ghc
    blend = files(CASE, f"{FORMULATIONS}.hqp_transition")
    assert {"formulations/hqp.py", "cascade/blend.py"} <= blend
    assert "pages/page.py" not in ghc | blend


def test_a_change_of_code_changes_the_digest_and_one_of_words_does_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "one.py").write_text("from benchmarks import two\n", encoding="utf-8")
    (tmp_path / "two.py").write_text("x = 1\n", encoding="utf-8")
    monkeypatch.setitem(module._ROOTS, "benchmarks", tmp_path)
    found = []
    words = '"""Some."""\n\n# why\nx = 1  # [m]\n'
    for text in ("x = 1\n", "x = 2\n", "x = '#1'\n", "x = '#2'\n", words):
        (tmp_path / "two.py").write_text(text, encoding="utf-8")
        forget()
        found.append(digest(["benchmarks.one"]))
    assert len(set(found)) == 4
    assert found[0] == found[-1]


def test_the_compiled_core_counts_for_studies_and_comparison_but_its_comments_do_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    core = tmp_path / "core"
    core.mkdir()
    (tmp_path / "__init__.py").write_text("", encoding="utf-8")
    monkeypatch.setattr(ghc_controller, "__file__", str(tmp_path / "__init__.py"))
    monkeypatch.setitem(module._ROOTS, "ghc_controller", tmp_path)
    found = []
    words = '/* rows\n of level */\n\nconst char* a = "// 1";  // [m]\n'
    for text in ("int a = 1;\n", "int a = 2;\n", 'const char* a = "// 1";\n', words):
        for name in ("level.cpp", "level.hpp"):
            (core / name).write_text(text, encoding="utf-8")
            forget()
            found.append((sources(), digest([])))
    assert len(set(found)) == 6
    assert len({one for one, _ in found}) == len({other for _, other in found}) == 6
    assert found[5:6] == found[7:]


def test_the_digest_reads_the_core_of_this_repository() -> None:
    files = {path.name for path in module._common_files()}
    assert {"cascade.cpp", "cascade.hpp", "step_module.cpp", "robot.yaml"} <= files


def test_digests_differ_between_methods_and_numbers_of_a_case() -> None:
    jobs = [
        Job("fencing_near", "task_priority"),
        Job("fencing_near", "task_priority_undamped"),
        Job("fencing_far", "task_priority"),
        Job("upper_body_ramp_w0.01", "ghc"),
        Job("upper_body_ramp_w0.0001", "ghc"),
    ]
    assert len({job_digest(job) for job in jobs}) == len(jobs)
    assert len(set(all_jobs())) == len(list(all_jobs()))
