"""The paper's runs and the document that is written from their summaries."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest

from ghc_controller.errors import UnknownName
from ghc_controller.formulations import DEFAULT_FORMULATION
from ghc_sim_bridge.programs.markdown import number, table
from ghc_sim_bridge.programs.paper import generator_sections as generators
from ghc_sim_bridge.programs.paper import motion_sections as motion
from ghc_sim_bridge.programs.paper import paper
from ghc_sim_bridge.programs.paper import switching_sections as switching
from ghc_sim_bridge.programs.paper.document import write_document
from ghc_sim_bridge.programs.paper.runs import (
    GENERATOR_PAIRS,
    PAPER_RUNS,
    beside,
    choose_runs,
    wants_studies,
)

TASKS = {"end_effector": "m", "elbow": "m", "posture": "rad"}
HIERARCHIES = ("posture > elbow > end_effector", "end_effector > elbow > posture")


def made_up(rate: float, jerk: float, second: float) -> dict[str, Any]:
    """A summary of two phases whose figures are easy to find again."""
    errors = [
        {"end_effector": 0.5, "elbow": second, "posture": 1e-7},
        {"end_effector": 1e-6, "elbow": second, "posture": 2.0},
    ]
    phases = [
        {"hierarchy": h, "t_start": 8.0 * k, "t_end": 8.0 * (k + 1), "errors": errors[k]}
        for k, h in enumerate(HIERARCHIES)
    ]
    beside = {"ghc": dict.fromkeys(TASKS, 0.125), "hqp": dict.fromkeys(TASKS, 0.25)}
    return {
        "phases": phases,
        "error_units": TASKS,
        "control_dt_s": 1e-3,
        "peak_torque_rate_nm_per_s": {"total": rate, "per_phase": [10.0, rate]},
        "jerk_integral": {"total": 2.0 * jerk, "per_phase": [jerk, jerk]},
        "rest": {"mean_speed_rad_per_s": [0.0, 0.1], "references_rest": [True, True]},
        "gated_ticks": 0,
        "torque_rate_limit_nm_per_s": None,
        "paper": {"phase_errors": [{"paper": beside}, {"paper": beside}]},
    }


SUMMARIES = {"hqp": made_up(20000.0, 1000.0, 0.3), "cascade": made_up(40.0, 100.0, 0.303)}


def test_the_table_holds_the_papers_figures_and_those_of_the_summaries() -> None:
    text = switching.table_section(SUMMARIES)
    assert "ours, cascade" in text and "ours, ghc" not in text
    assert "| 3▷2▷1, task 2 [m] | 0.12 | 0.25 | 0.303 | 0.3 |" in text
    assert "+1.0 %" in text  # 0.303 against 0.3


def test_ratios_follow_the_summaries_and_name_the_control_period() -> None:
    text = switching.transition_section(SUMMARIES, frozenset())
    assert "**500 times**" in text and "**10.0 times**" in text
    assert "at 1 ms" in text and "![" not in text
    changed = copy.deepcopy(SUMMARIES)
    changed["cascade"]["peak_torque_rate_nm_per_s"]["per_phase"][1] = 80.0
    assert "**250 times**" in switching.transition_section(changed, frozenset())


def test_a_picture_is_shown_only_when_it_was_written() -> None:
    text = switching.transition_section(SUMMARIES, frozenset({"switching_jerk.png"}))
    assert "figures/switching_jerk.png" in text
    assert "switching_rates.png" not in text


def test_sections_of_runs_that_were_not_made_are_left_out() -> None:
    assert switching.table_section({}) == ""
    assert switching.transition_section({}, frozenset()) == ""
    for section in (
        motion.insertion_section,
        motion.lemniscate_section,
        motion.contact_section,
        motion.nonstrict_section,
    ):
        assert section({}, frozenset()) == ""


def test_the_document_names_the_runs_that_are_missing(tmp_path: Path) -> None:
    text = write_document({}, tmp_path).read_text(encoding="utf-8")
    assert text.count("not run") >= len(PAPER_RUNS)
    assert all(f"`{run.name}`" in text for run in PAPER_RUNS)


def test_every_paper_run_has_a_folder_of_its_own(tmp_path: Path) -> None:
    folders = [run.plan(tmp_path).folder for run in PAPER_RUNS]
    assert len(set(folders)) == len(PAPER_RUNS)


def test_the_comparisons_that_the_paper_makes_are_there(tmp_path: Path) -> None:
    plans = {run.name: run.plan(tmp_path) for run in PAPER_RUNS}
    assert {plans[name].formulation for name in plans} >= {
        "cascade",
        "balanced",
        "ghc",
        "ghc_full",
        "hqp",
        "weighted",
    }
    assert (plans["hqp"].transition, plans["ghc_fast"].transition) == (0.0, 0.005)
    limited = [
        name for name, plan in plans.items() if plan.parameters["controller"]["torque_rate_limit"]
    ]
    assert limited == ["hqp_gated"]
    gated = plans["hqp_gated"].parameters
    assert gated["controller"]["torque_rate_limit"] == gated["sim_bridge"]["torque_rate_limit"]


def test_runs_are_chosen_by_name_or_scenario() -> None:
    assert choose_runs([]) == PAPER_RUNS
    chosen = [run.name for run in choose_runs(["hqp", "nonstrict"])]
    assert chosen[0] == "hqp"
    assert {*chosen[1:]} == {
        f"nonstrict_{alpha}{own}" for alpha in ("0.2", "0.5", "0.8") for own in ("", "_ghc")
    }
    with pytest.raises(UnknownName, match="lemniscate"):
        choose_runs(["no_such_run"])


def test_an_unknown_run_is_one_clear_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert paper.main(["--only", "no_such_run"]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1 and "no_such_run" in lines[0] and "hqp_gated" in lines[0]


def test_paper_goes_on_after_a_failed_run_and_ends_non_zero(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[str] = []

    def run(which: Any, output: Path) -> bool:
        made.append(which.name)
        return which.name != "hqp"

    def study(docs: Path) -> bool:
        made.append(docs.name)
        return True

    monkeypatch.setattr(paper, "_run", run)
    monkeypatch.setattr(paper, "_study", study)
    arguments = ["--output", str(tmp_path / "results"), "--docs", str(tmp_path / "docs")]
    assert paper.main(arguments) == 1
    assert sorted(made) == sorted([*(run.name for run in PAPER_RUNS), "docs"])
    assert (tmp_path / "docs" / "results.md").is_file()
    assert paper.main([*arguments, "--only", "ghc"]) == 0


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (None, "–"),
        (1.5, "1.5"),
        (0.303, "0.3"),
        (2.2e-30, "2.2e-30"),
        (123.4, "123"),
        (6.18e-4, "6.2e-4"),
    ],
)
def test_numbers_keep_two_significant_digits(value: float | None, text: str) -> None:
    assert number(value) == text


def test_a_table_has_as_many_marks_as_columns() -> None:
    assert table(["a", "b"], [["x", "1"]]) == "| a | b |\n| --- | ---: |\n| x | 1 |"


def compared(contacts: dict[str, Any], obstacles: dict[str, Any]) -> dict[str, Any]:
    """A summary with a comparison of one event."""
    event = {
        "name": "bound steps",
        "time_s": 5.0,
        "peak_torque_rate_nm_per_s": {"off": 5000.0, "on": 20.0},
        "ratio": 250.0,
    }
    data = {
        "formulation": "cascade",
        "control_dt_s": 1e-3,
        "events": [event],
        "contacts": contacts,
        "obstacles": obstacles,
    }
    return {"comparison": data}


def test_sections_on_generators_hold_the_ratio_of_every_event_and_how_bounds_were_kept() -> None:
    force = {
        "qp_violation": 0.0,
        "difference_rms": 0.05,
        "difference_largest": 4.5,
        "above_upper": 0.03,
    }
    way = {"qp_violation_m": 0.0, "inside_safe_distance_s": 1.5}
    summaries = {
        "force_bound_step": compared({"tip": {"off": force, "on": force}}, {}),
        "obstacle_jump": compared({}, {"wall": {"off": None, "on": way}}),
    }
    text = generators.force_section(summaries, frozenset({"force_bound_step.png"}))
    assert "| bound steps | 5 | 5000 | 20 | 250 |" in text
    assert "at most 4.5 N" in text and "contact `tip`, smoothed bounds" in text
    assert "figures/force_bound_step.png" in text and "at 1 ms" in text
    text = generators.obstacle_section(summaries, frozenset())
    assert "obstacle `wall`, smoothed bounds" in text and "for 1.5 s" in text
    assert "raw bounds: the distance" not in text and "![" not in text
    assert generators.force_section({}, frozenset()) == ""
    assert generators.obstacle_section({"obstacle_jump": {}}, frozenset()) == ""


def test_pairs_are_the_same_scenario_with_raw_and_with_smoothed_bounds(tmp_path: Path) -> None:
    plans = {run.name: run.plan(tmp_path) for run in PAPER_RUNS}
    for name, other in GENERATOR_PAIRS.items():
        assert plans[name].scenario.name == plans[other].scenario.name
        assert (plans[name].options.generators, plans[other].options.generators) == (True, False)
    with_generators = {p.scenario.name for p in plans.values() if p.scenario.generators}
    assert with_generators == {plans[name].scenario.name for name in GENERATOR_PAIRS}


def test_every_experiment_is_made_with_the_default_and_with_the_papers_own_formulation(
    tmp_path: Path,
) -> None:
    made: dict[tuple[str, str, bool | None], set[str]] = {}
    for run in PAPER_RUNS:
        plan = run.plan(tmp_path)
        key = (plan.scenario.name, plan.scenario.variant, run.options.generators)
        made.setdefault(key, set()).add(plan.formulation)
    assert len(made) == 11
    assert all(formulations >= {DEFAULT_FORMULATION, "ghc"} for formulations in made.values())
    named = {run.name: run for run in PAPER_RUNS}
    for name, run in named.items():
        if beside(name) in named:
            other = named[beside(name)].plan(tmp_path)
            assert other.scenario == run.plan(tmp_path).scenario
            assert other.formulation == "ghc"


def test_the_papers_own_formulation_stands_beside_the_default_in_every_table() -> None:
    rest = {"mean_speed_rad_per_s": [0.125, 0.25], "references_rest": [False, True]}
    runs = {
        "insertion_removal": made_up(40.0, 100.0, 0.303) | {"formulation": "cascade"},
        "insertion_removal_ghc": made_up(50.0, 100.0, 0.404)
        | {"formulation": "ghc", "rest": rest},
    }
    text = motion.insertion_section(runs, frozenset({"insertion_removal_tasks_ghc.png"}))
    assert f"| `{HIERARCHIES[1]}`, `cascade` | 16 | 1.0e-6 | 0.303 | 2 | 40 | 0.1 |" in (
        text.replace("1.00e-6", "1.0e-6")
    )
    assert f"`{HIERARCHIES[1]}`, `ghc`" in text and "| 50 | 0.25 |" in text
    assert "| 10 | – |" in text, "while a target moves no speed is left"
    assert "figures/insertion_removal_tasks_ghc.png" in text
    assert "figures/insertion_removal_tasks.png" not in text
    alone = motion.insertion_section({"insertion_removal": runs["insertion_removal"]}, frozenset())
    assert "`ghc`, " not in alone and "`cascade`" in alone
    both = {
        "obstacle_jump": compared({}, {}),
        "obstacle_jump_ghc": compared({}, {}),
    }
    both["obstacle_jump_ghc"]["comparison"]["formulation"] = "ghc"
    both["obstacle_jump_ghc"]["comparison"]["events"][0]["ratio"] = 125.0
    text = generators.obstacle_section(both, frozenset({"obstacle_jump_ghc.png"}))
    assert "| bound steps | 5 | 5000 | 20 | 250 | 5000 | 20 | 125 |" in text
    assert "`ghc`, raw bounds" in text and "figures/obstacle_jump_ghc.png" in text


def test_the_studies_are_made_with_everything_or_by_their_name() -> None:
    assert wants_studies([]) and wants_studies(["hqp", "studies"])
    assert not wants_studies(["hqp"])
    assert choose_runs(["studies"]) == ()
