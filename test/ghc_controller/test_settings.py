"""Settings are declared once; Python, YAML and ROS parameters read them alike."""

from __future__ import annotations

import math
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import Any

import pytest
import yaml

import ghc_controller as ghc
from ghc_controller.errors import ConfigurationError, InvalidValue
from ghc_controller.formulations import FORMULATIONS, Metric, make_formulation
from ghc_controller.robot.library import find_robot
from ghc_controller.ros.parameters import ControllerParameters
from ghc_controller.schema.declared import Entry, flat, flat_values
from ghc_controller.schema.domains import Range
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.settings import Settings

ENTRIES = tuple(flat(Settings))


def other(entry: Entry) -> Any:
    """A valid value that is not the default."""
    if isinstance(entry.default, Enum):
        return list(type(entry.default))[-1].value
    if isinstance(entry.default, bool):
        return not entry.default
    if isinstance(entry.default, int):
        return entry.default + 1
    if isinstance(entry.default, float):
        larger = abs(entry.default) * 2.0 + 0.5
        domain = entry.declaration.domain or Range()
        return entry.default / 2.0 if domain.problem(larger) else larger
    if isinstance(entry.default, tuple):
        return ["torque_limit"]
    return "hqp" if entry.name == "formulation" else "proxqp"


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.name)
def test_every_number_is_set_in_python_as_in_a_file_or_a_parameter(entry: Entry) -> None:
    value = other(entry)
    in_python = ghc.Settings.of(**{entry.name: value})
    in_yaml = read(Fields({entry.name: value}, "scenario.yaml"), Settings)
    as_parameter = read(
        Fields({"robot": "kuka_lwr", entry.name: value}, "parameters"), ControllerParameters
    )
    assert in_python == in_yaml == as_parameter.settings != Settings()
    changed = {e.name for e, v in flat_values(in_python) if v != e.default}
    assert changed == {entry.name}


def test_names_are_unique_and_every_field_says_what_it_means() -> None:
    names = [entry.name for entry in flat(ControllerParameters)]
    assert len(set(names)) == len(names)
    for entry in flat(ControllerParameters):
        assert entry.declaration.text
        if isinstance(entry.default, (int, float)) and not isinstance(entry.default, bool):
            assert entry.declaration.unit, entry.name


@pytest.mark.parametrize("name", [e.name for e in ENTRIES if isinstance(e.default, float)])
@pytest.mark.parametrize("value", [math.nan, math.inf, "fast", True, None])
def test_what_is_no_finite_number_is_refused_by_name(name: str, value: object) -> None:
    with pytest.raises(ConfigurationError, match=name):
        ghc.Settings.of(**{name: value})


def test_made_directly_settings_are_checked_alike() -> None:
    with pytest.raises(InvalidValue, match="control_dt: a number above 0 expected, -1"):
        Settings(control_dt=-1.0)
    with pytest.raises(InvalidValue, match="velocity_damping: a number >= 0 expected"):
        ghc.FormulationSettings(velocity_damping=-1.0)


def test_an_unknown_name_lists_those_that_exist() -> None:
    with pytest.raises(
        ConfigurationError, match=r"velocity_dampin: unknown field; known: .*metric"
    ):
        ghc.Settings.of(velocity_dampin=1.0)


def test_a_record_may_start_from_another_one() -> None:
    base = replace(Settings(), control_dt=0.01)
    fields = Fields({"metric": "inertia"}, "robot.yaml")
    merged = read(fields, Settings, base=base)
    assert merged.control_dt == 0.01
    assert merged.optimization.metric is Metric.INERTIA


@pytest.mark.parametrize("name", FORMULATIONS)
def test_a_formulation_gets_its_numbers(name: str) -> None:
    settings = ghc.Settings.of(regularization=0.5, layer_damping=0.25)
    formulation = make_formulation(name, settings.optimization)
    assert formulation.settings.regularization == 0.5
    assert formulation.projector.layer_damping == 0.25


def robot_with(tmp_path: Path, settings: dict[str, Any]) -> ghc.Robot:
    """The LWR with a section `settings` in its robot.yaml."""
    source = find_robot("kuka_lwr")
    values = yaml.safe_load(source.read_text(encoding="utf-8")) | {"settings": settings}
    values["urdf"] = str(source.parent / values["urdf"])
    file = tmp_path / "robot.yaml"
    file.write_text(yaml.safe_dump(values), encoding="utf-8")
    return ghc.load_robot(file)


def test_a_robot_may_bring_its_own_settings(tmp_path: Path) -> None:
    """They hold unless the caller gives others."""
    robot = robot_with(tmp_path, {"velocity_damping": 5.0, "formulation": "hqp"})
    controller = ghc.Controller(robot)
    assert controller.formulation.name == "hqp"
    assert controller.settings == ghc.Settings.of(velocity_damping=5.0, formulation="hqp")
    assert ghc.Controller(robot, Settings()).settings == Settings()
    assert ghc.Controller(ghc.load_robot("kuka_lwr")).settings == Settings()


def test_a_wrong_setting_of_a_robot_is_told_file_and_field(tmp_path: Path) -> None:
    robot = robot_with(tmp_path, {"metric": "distance"})
    with pytest.raises(ConfigurationError, match=r"robot.yaml: settings.metric: 'distance' given"):
        ghc.Controller(robot)
