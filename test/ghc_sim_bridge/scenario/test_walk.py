"""A planned walk: feet swing while their contacts are off, somebody always carries the body."""

from __future__ import annotations

import dataclasses
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from ghc_controller.errors import ConfigurationError
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_controller.schema.record import read as record
from ghc_sim_bridge.scenario.scenario import find_scenario, load_scenario
from ghc_sim_bridge.scenario.walk.walk import (
    Walk,
    walk_events,
    walk_references,
    walk_schedules,
    walk_steps,
    wanted_zmp,
)

WEIGHT = 324.0  # [N] of the humanoid


def section() -> dict[str, Any]:
    return read_yaml(find_scenario("walking")).section("walk").values


def read(data: dict[str, Any]) -> Walk:
    return record(Fields(data, "walking.yaml", "walk"), Walk)


@pytest.fixture
def walk() -> Walk:
    return read(section())


def test_the_feet_take_turns_and_end_side_by_side(walk: Walk) -> None:
    steps = tuple(walk_steps(walk))
    assert [step.swing for step in steps] == [0, 1, 0, 1, 0, 1]
    assert [step.goal for step in steps] == pytest.approx([0.06, 0.12, 0.18, 0.24, 0.30, 0.30])
    for before, after in pairwise(steps):
        assert after.stance == before.goal
        assert after.begins == pytest.approx(before.touches)


def test_a_foot_moves_only_while_its_contact_is_off(walk: Walk) -> None:
    _, *feet = walk_references(walk)
    for foot, schedule, start in zip(feet, walk_schedules(walk), walk.feet, strict=True):
        assert foot.task == start.task
        assert schedule.contact == start.contact
        for a, b in pairwise(foot.points):
            if a.position == b.position:
                continue
            upper = schedule.upper[np.searchsorted(schedule.times, a.time, "right") - 1]
            assert upper == 0.0
        on_the_ground = [p for p in foot.points if p.position[2] == pytest.approx(start.pose[2])]
        assert all(not any(p.velocity) for p in on_the_ground)


def test_the_feet_that_stand_may_carry_the_weight_at_any_time(walk: Walk) -> None:
    for time in np.arange(0.0, 10.0, 0.01) + 0.005:
        upper = [
            s.upper[int(np.searchsorted(s.times, time, "right")) - 1] for s in walk_schedules(walk)
        ]
        assert sum(upper) > 1.2 * WEIGHT


def test_the_center_of_mass_starts_and_ends_at_rest_between_the_feet(walk: Walk) -> None:
    points = walk_references(walk)[0].points
    assert points[0].position == pytest.approx(walk.center_of_mass, abs=1e-9)
    assert points[0].acceleration == pytest.approx((0, 0, 0), abs=1e-6)
    carried = np.add(walk.center_of_mass, [0.30, 0.0, 0.0])
    assert points[-1].position == pytest.approx(carried, abs=1e-3)
    assert points[-1].velocity == pytest.approx((0, 0, 0), abs=1e-3)
    sway = max(abs(p.position[1]) for p in points)
    assert sway < 0.0701  # less than the zero-moment point
    assert np.abs(wanted_zmp(walk)[:, 1]).max() == pytest.approx(0.0701)


def test_events_are_the_breaks_and_touches_of_the_schedules(walk: Walk) -> None:
    events = walk_events(walk)
    assert len(events) == 2 * walk.steps
    assert [e.time for e in events] == sorted(e.time for e in events)
    zeros = {
        t for s in walk_schedules(walk) for t, f in zip(s.times, s.upper, strict=True) if not f
    }
    assert zeros == {e.time for e in events if e.name.endswith("breaks")}


def test_a_single_step_stays_where_it_is(walk: Walk) -> None:
    (step,) = walk_steps(dataclasses.replace(walk, steps=1))
    assert step.goal == step.origin == 0.0


def test_the_scenario_takes_references_schedules_and_events_from_the_walk() -> None:
    scenario = load_scenario("walking")
    assert [r.task for r in scenario.references] == ["center_of_mass", "right_foot", "left_foot"]
    assert [s.contact for s in scenario.contact_schedules] == ["right_sole", "left_sole"]
    assert len(scenario.events) == 12


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"steps": 2.5}, "walk.steps: a whole number expected, 2.5 given"),
        ({"feet": []}, "walk.feet: 2 entries expected, 0 given"),
        ({"center_of_mass": [0.0, 0.5]}, "3 numbers expected, 2 given"),
        ({"center_of_mass": [0.0, 0.0, 0.0]}, "a height above 0 expected, 0 given"),
        ({"double_support": 1.0}, "are left for the swing"),
        ({"stride": 0.1}, "walk.stride: unknown field"),
    ],
)
def test_a_bad_walk_is_refused_with_its_field(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigurationError, match=message):
        read(section() | change)


def test_an_event_at_the_time_of_one_of_the_walk_is_refused_with_its_file(
    walk: Walk, tmp_path: Path
) -> None:
    values = yaml.safe_load(find_scenario("walking").read_text(encoding="utf-8"))
    values["events"] = [{"time": walk_events(walk)[0].time, "name": "push"}]
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump(values), encoding="utf-8")
    with pytest.raises(ConfigurationError, match=r"mine.yaml: events\[1\].time: more than"):
        load_scenario(str(file))
