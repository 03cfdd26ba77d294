"""README shows what is true: its commands parse, its example runs, its numbers are the code's."""

from __future__ import annotations

import ast
import re
import shlex
import subprocess
import sys
from collections.abc import Mapping
from typing import Any

import pytest
import yaml
from doc_text import README, ROOT, blocks, commands
from ghc_msgs import msg
from PIL import Image

from docs.interface_tables import NODES
from ghc_controller.formulations import FORMULATIONS
from ghc_controller.hierarchy import matrix_from_hierarchy
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.ros.by_hand.reference import _parser as reference_arguments
from ghc_controller.ros.conversions.requests import reference_from_message, transition_from_message
from ghc_controller.ros.parameters import ControllerParameters
from ghc_controller.ros.transition import _parser as transition_arguments
from ghc_controller.schema.declared import flat
from ghc_sim_bridge.analysis.phase_table import phase_table
from ghc_sim_bridge.bridge.realtime import FRESH_COMMANDS_TO_RESUME
from ghc_sim_bridge.parameters import BridgeParameters
from ghc_sim_bridge.run.executables import find_executable
from ghc_sim_bridge.scenario.scenario import load_scenario

TEXT = README.read_text(encoding="utf-8")
COMMANDS = commands(README)
PICTURE_LIMIT = 1_000_000  # [bytes]
ROBOT = load_robot_config(find_robot("kuka_lwr"))


def table(first_cell: str) -> list[list[str]]:
    """Rows of the table whose header begins with a cell."""
    part = TEXT.split(f"| {first_cell} |", 1)[1].split("\n\n", 1)[0]
    lines = part.splitlines()[2:]
    return [[cell.strip(" `") for cell in line.split("|")[1:-1]] for line in lines]


def example() -> str:
    (block,) = blocks(README, "python")
    return block.text


def fill(message: Any, values: Mapping[str, Any]) -> None:
    """Set fields of a message as `ros2 topic pub` does."""
    kinds = message.get_fields_and_field_types()
    for name, value in values.items():
        if isinstance(value, dict):
            fill(getattr(message, name), value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            kind = getattr(msg, kinds[name].removesuffix(">").split("/")[1])
            items = [kind() for _ in value]
            for item, entry in zip(items, value, strict=True):
                fill(item, entry)
            setattr(message, name, items)
        else:
            setattr(message, name, value)


def test_the_first_screen_has_picture_qp_flow_and_the_two_commands() -> None:
    start = TEXT.split("```bash", 1)[0]
    pictures = [ROOT / path for path in re.findall(r"!\[[^]]+\]\(([^)]+)\)", start)]
    assert pictures and start.count("\n") < 45
    assert "min_x" in start and "sim_bridge" in start
    assert COMMANDS[:2] == ["make demo", "make test"]
    assert all(file.stat().st_size < PICTURE_LIMIT for file in pictures)
    frames = []
    for file in pictures:
        with Image.open(file) as image:
            frames.append(getattr(image, "n_frames", 1))
    assert max(frames) > 20


def test_the_library_example_is_short_and_prints_what_is_shown() -> None:
    code = example()
    assert len(code.splitlines()) < 25
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert run.returncode == 0, run.stderr
    shown = TEXT.split(code, 1)[1].split("```")[2].strip().splitlines()
    assert len(shown) == len(run.stdout.splitlines()) == 3
    for line, expected in zip(run.stdout.splitlines(), shown, strict=True):
        time, errors = line.split(": ", 1)
        expected_time, expected_errors = expected.split(": ", 1)
        assert time == expected_time
        assert ast.literal_eval(errors) == pytest.approx(
            ast.literal_eval(expected_errors), abs=2e-3
        )


def test_runs_name_scenarios_and_formulations_that_exist() -> None:
    runs = [command for command in COMMANDS if command.startswith("make run")]
    assert len(runs) >= 4
    for command in runs:
        options = dict(word.split("=") for word in shlex.split(command)[2:])
        load_scenario(options["SCENARIO"])
        assert options.get("FORMULATION", "balanced") in FORMULATIONS
        assert float(options.get("TRANSITION", 0.0)) >= 0.0


def test_nodes_by_hand_have_these_executables_and_parameters() -> None:
    starts = [shlex.split(c) for c in COMMANDS if c.startswith("python tools/ros2_run.py")]
    executables = ["sim_bridge", "controller", "viewer", "reference", "transition"]
    executables.append("reachable_targets")
    assert [words[3] for words in starts] == executables
    for _, _, package, executable, *arguments in starts:
        assert find_executable(package, executable).is_file()
        if executable == "transition":
            options = transition_arguments().parse_args(arguments)
            matrix_from_hierarchy(ROBOT.task_names, options.hierarchy)
        elif executable == "reference":
            options = reference_arguments().parse_args(arguments)
            task = next(task for task in ROBOT.tasks if task.name == options.task)
            assert len(options.position) == task.position_size
        else:
            names = {entry.name for entry in flat(NODES[executable])}
            given = [word.partition(":=")[0] for word in arguments if ":=" in word]
            assert given and set(given) <= names


def test_messages_by_hand_are_what_the_controller_takes() -> None:
    published = [shlex.split(c) for c in COMMANDS if c.startswith("ros2 topic pub")]
    assert [words[4] for words in published] == [
        "/ghc/priority_transition",
        "/ghc/task_reference",
    ]
    transition, reference = msg.PriorityTransition(), msg.TaskReference()
    fill(transition, yaml.safe_load(published[0][6]))
    assert transition_from_message(transition, ROBOT.task_names, 0.0).duration == 2.0
    fill(reference, yaml.safe_load(published[1][6]))
    task = next(task for task in ROBOT.tasks if task.name == reference.task)
    reference_from_message(reference, task, task.current(ROBOT.model), 0.0)


def test_every_hierarchy_that_is_shown_parses() -> None:
    shown = re.findall(r"'([a-z_]+(?: [>=] [a-z_]+)+)'|\"([a-z_]+(?: [>=] [a-z_]+)+)\"", TEXT)
    assert len(shown) >= 3
    for single, double in shown:
        matrix_from_hierarchy(ROBOT.task_names, single or double)


def test_topics_are_those_of_the_interfaces() -> None:
    interfaces = (ROOT / "docs" / "interfaces.md").read_text(encoding="utf-8")
    for topic, kind, *_ in table("topic"):
        assert f"| `{topic}` | `{kind.replace('/', '/msg/')}` |" in interfaces, topic


def test_parameters_have_these_defaults_and_units() -> None:
    known = {entry.name: entry for entry in flat(ControllerParameters)}
    for name, default, unit, _ in table("parameter"):
        entry = known[name]
        assert default == str(entry.default), name
        if unit:
            assert entry.declaration.unit == unit, name


def test_all_formulations_are_named() -> None:
    assert {row[0] for row in table("formulation")} == set(FORMULATIONS)


def test_the_shown_table_is_that_of_the_demo() -> None:
    scenario = load_scenario("priority_switching")
    head, _, *rows = next(
        b.text for b in blocks(README) if b.text.startswith("phase")
    ).splitlines()
    tasks = {"end_effector": "m", "elbow": "m", "posture": "rad"}
    summary: dict[str, Any] = {
        "control_dt_s": scenario.control_dt,
        "error_units": tasks,
        "phases": [],
        "peak_torque_rate_nm_per_s": {"per_phase": []},
        "jerk_integral": {"per_phase": []},
    }
    columns = re.split(r" {2,}", phase_table(summary).splitlines()[0].strip())
    assert set(re.split(r" {2,}", head.strip())) <= set(columns)
    for row, phase in zip(rows, scenario.phases, strict=False):
        assert f"  {phase.hierarchy}  " in row
    assert len(rows) == len(scenario.phases) + 1


def test_numbers_of_the_safety_section() -> None:
    defaults: dict[str, Any] = {entry.name: entry.default for entry in flat(BridgeParameters)}
    assert f"default {ROBOT.torque_rate:g} Nm/s" in TEXT
    assert f"after {1e3 * defaults['watchdog_timeout']:g} ms without one" in TEXT
    assert f"after {defaults['lockstep_timeout']:g} s the run ends" in TEXT
    assert FRESH_COMMANDS_TO_RESUME == 3 and "three fresh commands in a row" in TEXT
