"""Scenario files: what they promise, how they are timed, and what a wrong one is told."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from ghc_controller.errors import ConfigurationError, InvalidValue, UnknownName
from ghc_sim_bridge.programs import experiment
from ghc_sim_bridge.ros.experiment_conversions import transition_message
from ghc_sim_bridge.ros.experiment_driver import scripted_transitions
from ghc_sim_bridge.scenario.plan import RunOptions
from ghc_sim_bridge.scenario.planning import make_plan, parse_parameter
from ghc_sim_bridge.scenario.references import Lemniscate
from ghc_sim_bridge.scenario.scenario import load_scenario, scenario_names
from ghc_sim_bridge.scene.description import load_scene

PAPER_SCENARIOS = (
    "contact_force",
    "insertion_removal",
    "lemniscate",
    "nonstrict",
    "priority_switching",
)
MINIMAL = {
    "title": "t",
    "robot": "kuka_lwr",
    "scene": "kuka_lwr",
    "torque_rate_limit": 0.0,
    "phases": [{"hierarchy": "a > b"}, {"hierarchy": "b > a", "hold": 3.0}],
}


def write(folder: Path, **changes: object) -> str:
    """A minimal scenario file with changes; None removes a field."""
    data = {key: value for key, value in (MINIMAL | changes).items() if value is not None}
    file = folder / "mine.yaml"
    file.write_text(yaml.safe_dump(data), encoding="utf-8")
    return str(file)


@pytest.mark.parametrize("name", PAPER_SCENARIOS)
def test_paper_scenarios_settle_run_at_1_khz_and_leave_the_rate_limit_off(name: str) -> None:
    variants = load_scenario(name).variants or ("",)
    for variant in variants:
        scenario = load_scenario(name, variant)
        assert scenario.control_dt == 1e-3
        assert scenario.transition == 2.0
        assert scenario.torque_rate_limit == 0.0
        assert all(phase.hold >= 8.0 for phase in scenario.phases)
        assert {reference.task for reference in scenario.references} == {
            "end_effector",
            "elbow",
            "posture",
        }


def test_all_paper_scenarios_are_found_by_name() -> None:
    assert set(PAPER_SCENARIOS) <= set(scenario_names())


def test_nonstrict_variants_are_matrices_whose_pair_sums_to_one() -> None:
    given = set()
    for variant in load_scenario("nonstrict").variants:
        table = load_scenario("nonstrict", variant).phases[0].table
        assert table is not None
        alpha = np.array(table.alpha)
        assert alpha[0, 1] + alpha[1, 0] == pytest.approx(1.0)
        given.add(float(alpha[0, 1]))
    assert given == {0.2, 0.5, 0.8}


def test_phases_follow_each_other_on_the_grid_of_the_control_period(tmp_path: Path) -> None:
    plan = make_plan(load_scenario(write(tmp_path)), RunOptions(transition=0.005), tmp_path)
    assert [(p.start, p.end, p.ramp) for p in plan.phases] == [(0, 8, 0), (8, 11.005, 0.005)]
    assert plan.duration == plan.parameters["sim_bridge"]["stop_time"] == 11.005


def test_hqp_switches_at_once_unless_a_transition_is_asked_for(tmp_path: Path) -> None:
    scenario = load_scenario(write(tmp_path))
    assert make_plan(scenario, RunOptions(formulation="hqp"), tmp_path).transition == 0.0
    asked = make_plan(scenario, RunOptions(formulation="hqp", transition=2.0), tmp_path)
    assert asked.transition == 2.0
    assert make_plan(scenario, RunOptions(formulation="ghc"), tmp_path).transition == 2.0


def test_only_the_scenario_as_it_stands_is_the_default_variant(tmp_path: Path) -> None:
    scenario = load_scenario(write(tmp_path))
    options = (
        RunOptions(formulation="ghc"),
        RunOptions(transition=0.005),
        RunOptions(torque_rate=50.0),
        RunOptions(control_dt=0.002),
        RunOptions(mode="realtime"),
        RunOptions(parameters=(("controller", "torque_rate_limit", 1000),)),
    )
    plans = [make_plan(scenario, option, tmp_path) for option in options]
    assert make_plan(scenario, RunOptions(), tmp_path).is_default
    assert not any(plan.is_default for plan in plans)
    assert len({plan.folder for plan in plans}) == len(plans)


def test_a_torque_rate_goes_with_every_transition_and_into_the_name_of_the_folder(
    tmp_path: Path,
) -> None:
    table = {"tasks": ["end_effector"], "alpha": [[0.0]]}
    phases = [table, {"hierarchy": "posture"}, {"hierarchy": "elbow"}]
    own = load_scenario(write(tmp_path, torque_rate=40.0, phases=phases))
    for options, rate, folder in (
        (RunOptions(), 40.0, "cascade"),
        (RunOptions(torque_rate=40.0), 40.0, "cascade"),
        (RunOptions(torque_rate=75.5), 75.5, "cascade-torque_rate_75.5"),
        (RunOptions(torque_rate=0.0), 0.0, "cascade-torque_rate_0"),
    ):
        plan = make_plan(own, options, tmp_path)
        assert (plan.torque_rate, plan.folder.name) == (rate, folder)
        # The priorities at the start come at once: there is no ramp that could keep it.
        sent = [transition_message(item, 0.0).torque_rate for item in scripted_transitions(plan)]
        assert sent == [0.0, rate, rate]
    assert load_scenario(write(tmp_path)).torque_rate == 0.0


@pytest.mark.parametrize("formulation", ["hqp", "ghc", "ghc_full", "balanced", "weighted"])
def test_a_torque_rate_is_refused_with_a_formulation_that_cannot_keep_it(
    tmp_path: Path, formulation: str
) -> None:
    options = RunOptions(formulation=formulation, torque_rate=50.0)
    with pytest.raises(InvalidValue, match=f"50 Nm/s: .*'{formulation}'.*cascade"):
        make_plan(load_scenario(write(tmp_path)), options, tmp_path)
    own = load_scenario(write(tmp_path, torque_rate=40.0))
    with pytest.raises(InvalidValue, match="40 Nm/s"):
        make_plan(own, RunOptions(formulation=formulation), tmp_path)
    free = RunOptions(formulation=formulation, torque_rate=0.0)
    assert make_plan(own, free, tmp_path).torque_rate == 0.0


def test_a_parameter_reaches_its_node_and_keeps_its_type(tmp_path: Path) -> None:
    given = parse_parameter("controller:torque_rate_limit:=1000")
    plan = make_plan(load_scenario(write(tmp_path)), RunOptions(parameters=(given,)), tmp_path)
    assert plan.parameters["controller"]["torque_rate_limit"] == 1000.0
    assert isinstance(plan.parameters["controller"]["torque_rate_limit"], float)
    assert plan.parameters["sim_bridge"]["torque_rate_limit"] == 0.0


def test_parameters_of_a_formulation_are_used_with_it_alone(tmp_path: Path) -> None:
    extra = {"ghc": {"layer_damping": 0.5}}
    scenario = load_scenario(write(tmp_path, formulation_parameters=extra))
    for formulation, value in (("ghc", 0.5), ("balanced", None)):
        plan = make_plan(scenario, RunOptions(formulation=formulation), tmp_path)
        assert plan.parameters["controller"].get("layer_damping") == value


@pytest.mark.parametrize("text", ["controller", "controller:x", "x:=1", "controller::=1"])
def test_a_malformed_parameter_shows_the_form(text: str) -> None:
    with pytest.raises(InvalidValue, match="node:name:=value"):
        parse_parameter(text)


@pytest.mark.parametrize(
    ("options", "error"),
    [
        (RunOptions(transition=-1.0), InvalidValue),
        (RunOptions(transition=math.nan), InvalidValue),
        (RunOptions(torque_rate=-1.0), InvalidValue),
        (RunOptions(torque_rate=math.inf), InvalidValue),
        (RunOptions(control_dt=0.0), InvalidValue),
        (RunOptions(mode="fast"), UnknownName),
    ],
)
def test_options_out_of_range_are_refused(
    tmp_path: Path, options: RunOptions, error: type[Exception]
) -> None:
    with pytest.raises(error):
        make_plan(load_scenario(write(tmp_path)), options, tmp_path)


def test_an_unknown_scenario_or_variant_names_those_that_exist() -> None:
    with pytest.raises(UnknownName, match="priority_switching"):
        load_scenario("no_such_scenario")
    with pytest.raises(UnknownName, match=r"alpha_12_0\.2"):
        load_scenario("nonstrict", "alpha_12_0.3")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"title": None}, ["title", "missing", "robot"]),
        ({"titel": "t"}, ["titel", "unknown", "title"]),
        ({"control_dt": "fast"}, ["control_dt", "number", "'fast'"]),
        ({"transition": -1}, ["transition", "number >= 0", "-1"]),
        ({"transition": math.nan}, ["transition", "finite"]),
        ({"torque_rate": -1}, ["torque_rate", "number >= 0", "-1"]),
        ({"phases": []}, ["phases", "none given"]),
        ({"phases": [{"hold": 1.0}]}, ["phases[0].hierarchy", "missing"]),
        ({"phases": [{"tasks": ["a"], "alpha": [[2.0]]}]}, ["phases[0].alpha[0]", "[0, 1]"]),
        ({"phases": [{"tasks": ["a", "b"], "alpha": [[0.0]]}]}, ["phases[0].alpha", "2 rows"]),
        ({"references": {"a": {"place": [0]}}}, ["references.a", "position", "place"]),
        ({"references": {"a": {"points": []}}}, ["references.a.points", "none given"]),
        ({"references": {"a": {"position": [0, None]}}}, ["references.a.position[1]", "None"]),
        ({"formulation_parameters": {"magic": {}}}, ["formulation_parameters.magic", "hqp"]),
        ({"parameters": {"arm": {}}}, ["parameters.arm", "controller"]),
        (
            {"parameters": {"controller": {"velocity_dampin": 1.0}}},
            ["parameters.controller.velocity_dampin", "unknown field", "velocity_damping"],
        ),
        (
            {"formulation_parameters": {"ghc": {"metric": "distance"}}},
            ["formulation_parameters.ghc.metric", "acceleration, inertia, torque"],
        ),
        (
            {"generators": {"obstacle_bounds": {"max_velocity": 0}}},
            ["generators.obstacle_bounds.max_velocity", "a number above 0 expected, 0 given"],
        ),
    ],
)
def test_a_wrong_file_is_told_file_field_and_what_was_given(
    tmp_path: Path, changes: dict[str, object], words: list[str]
) -> None:
    path = write(tmp_path, **changes)
    with pytest.raises(ConfigurationError) as caught:
        load_scenario(path)
    for word in ["mine.yaml", *words]:
        assert word in str(caught.value)


def test_points_must_advance_in_time(tmp_path: Path) -> None:
    points = [{"time": 1.0, "position": [0.0]}, {"time": 1.0, "position": [1.0]}]
    with pytest.raises(ConfigurationError, match="more than 1 s"):
        load_scenario(write(tmp_path, references={"a": {"points": points}}))


def test_lemniscate_derivatives_match_finite_differences() -> None:
    curve = Lemniscate((0.4, 0.0, 0.4), (0.06, 0.0, 0.02), (0.0, 0.03, 0.01), 2 * math.pi, 0.02)
    step = 1e-5
    for time in np.random.default_rng(1).uniform(0.0, 7.0, size=20):
        before, now, after = (curve.point(time + d) for d in (-step, 0.0, step))
        for derivative, values in (
            (now.velocity, (before.position, after.position)),
            (now.acceleration, (before.velocity, after.velocity)),
        ):
            difference = (np.array(values[1]) - np.array(values[0])) / (2 * step)
            np.testing.assert_allclose(derivative, difference, atol=1e-8)


def test_lemniscate_points_cover_the_run(tmp_path: Path) -> None:
    reference = next(r for r in load_scenario("lemniscate").references if r.lemniscate)
    points = reference.points_until(12.345)
    assert points[0].time == 0.0
    assert points[-1].time >= 12.345
    period = reference.lemniscate.period if reference.lemniscate else 0.0
    assert period == pytest.approx(2 * math.pi)


GENERATED = ("force_bound_step", "obstacle_jump")


@pytest.mark.parametrize("name", GENERATED)
def test_generators_run_beside_the_controller_which_waits_for_them(
    tmp_path: Path, name: str
) -> None:
    scenario = load_scenario(name)
    on, off = (make_plan(scenario, RunOptions(generators=g), tmp_path) for g in (True, False))
    (generator,) = scenario.generators
    assert on.parameters[generator]["smoothing"] is True
    assert off.parameters[generator]["smoothing"] is False
    assert on.folder != off.folder
    assert on.is_default and not off.is_default
    assert make_plan(scenario, RunOptions(), tmp_path).folder == on.folder
    waited_for = {
        "contact_force_bounds": "contact_forces",
        "obstacle_bounds": "obstacle_motion",
    }
    for plan in (on, off):
        assert plan.parameters["controller"]["wait_for_bounds"] == [waited_for[generator]]
        assert plan.parameters["controller"]["torque_rate_limit"] == 0.0
        assert plan.parameters["sim_bridge"]["torque_rate_limit"] == 0.0
        assert plan.control_dt == 1e-3
    realtime = make_plan(scenario, RunOptions(mode="realtime"), tmp_path)
    assert "wait_for_bounds" not in realtime.parameters["controller"]


def test_the_obstacle_generator_waits_for_the_sensor_of_the_scene(tmp_path: Path) -> None:
    plan = make_plan(load_scenario("obstacle_jump"), RunOptions(), tmp_path)
    assert plan.parameters["obstacle_bounds"]["sensor_period"] == 0.1


def test_a_share_by_distance_runs_beside_the_controller_in_its_first_order(
    tmp_path: Path,
) -> None:
    scenario = load_scenario("avoidance_distance")
    value = parse_parameter("priority_share:lag:=0.1")
    plan = make_plan(scenario, RunOptions(parameters=(value,)), tmp_path)
    share = plan.parameters["priority_share"]
    assert share["first"] == plan.parameters["controller"]["hierarchy"]
    assert share["second"] == share["first"].replace(" > hand >", " >")
    assert share["lag"] == 0.1
    with pytest.raises(UnknownName):
        make_plan(load_scenario("avoidance_ramp"), RunOptions(parameters=(value,)), tmp_path)
    wrong = {"priority_share": {"first": "posture", "task": "elbow"}}
    with pytest.raises(ConfigurationError, match=r"priority_share\.second"):
        load_scenario(write(tmp_path, **wrong))


def test_events_are_the_jumps_of_what_is_scripted() -> None:
    force = load_scenario("force_bound_step")
    assert [event.time for event in force.events] == list(force.contact_schedules[0].times[1:])
    for name in ("obstacle_jump", "table_obstacle"):
        jumps = load_scenario(name)
        track = load_scene(jumps.scene).obstacles[0].track
        assert [event.time for event in jumps.events] == [sighting.time for sighting in track[1:]]


def test_the_object_jumps_five_centimetres_into_the_safe_distance_of_the_hand() -> None:
    """Thesis, section 4.5: d_s = 0.06 m and d_v = 0.05 m, where the hand is at that moment."""
    scenario = load_scenario("table_obstacle")
    (obstacle,) = load_scene(scenario.scene).obstacles
    hand = next(r for r in scenario.references if r.task == "left_hand").lemniscate
    assert hand is not None and max(hand.along) == 0.04
    sighting = obstacle.track[1]
    assert sighting.position is not None
    gap = np.array(hand.point(sighting.time).position) - sighting.position
    assert obstacle.safe_distance == 0.06
    assert obstacle.safe_distance - gap @ np.array(obstacle.normal) == pytest.approx(
        0.05, abs=1e-4
    )


def test_generators_of_a_scenario_without_any_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidValue, match="generators off: scenario 'mine' has no section"):
        make_plan(load_scenario(write(tmp_path)), RunOptions(generators=False), tmp_path)


def test_generators_with_steps_that_differ_are_refused(tmp_path: Path) -> None:
    steps = {"contact_force_bounds": {"step": 0.01}, "obstacle_bounds": {"step": 0.02}}
    with pytest.raises(InvalidValue, match="one step expected"):
        make_plan(load_scenario(write(tmp_path, generators=steps)), RunOptions(), tmp_path)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"generators": {"walls": {}}}, ["generators.walls", "obstacle_bounds"]),
        ({"generators": {"obstacle_bounds": None}}, ["generators.obstacle_bounds", "no value"]),
        ({"contact_schedules": [{"contact": "a", "bounds": []}]}, ["contact_schedules[0].bounds"]),
        (
            {"contact_schedules": [{"contact": "a", "bounds": [{"time": 0, "upper": 1}]}]},
            ["contact_schedules[0].bounds[0].lower", "missing"],
        ),
        (
            {
                "contact_schedules": [
                    {"contact": "a", "bounds": [{"time": 0, "lower": 0, "upper": 1}]}
                ]
            },
            ["contact_schedules", "nobody reads them"],
        ),
        (
            {"events": [{"time": 2, "name": "a"}, {"time": 1, "name": "b"}]},
            ["events[1].time", "more than 2"],
        ),
    ],
)
def test_what_is_wrong_with_generators_is_told_by_its_field(
    tmp_path: Path, changes: dict[str, object], words: list[str]
) -> None:
    with pytest.raises(ConfigurationError) as caught:
        load_scenario(write(tmp_path, **changes))
    for word in ["mine.yaml", *words]:
        assert word in str(caught.value)


@pytest.mark.parametrize("name", scenario_names())
def test_scenarios_of_the_package_load_in_every_variant(name: str) -> None:
    for variant in load_scenario(name).variants or ("",):
        assert load_scenario(name, variant).name == name


def test_a_generator_without_parameters_is_an_empty_mapping(tmp_path: Path) -> None:
    generators: dict[str, object] = {"contact_force_bounds": {}, "obstacle_bounds": {}}
    assert load_scenario(write(tmp_path, generators=generators)).generators == generators


SCHEDULED = {
    "generators": {"contact_force_bounds": {}},
    "contact_schedules": [
        {"contact": "nose", "bounds": [{"time": 0.0, "lower": 0.0, "upper": 9.0}]}
    ],
}
TOOL = {"name": "tool", "frame": "tool", "points": [[0, 0, 0]], "normal": [0, 0, 1]}


@pytest.mark.parametrize("kind", ["joint", "torque"])
def test_a_schedule_of_a_joint_that_the_robot_has_not_starts_nothing(
    tmp_path: Path, kind: str
) -> None:
    """It would bound nothing, with a warning in a log."""
    limits = [{"time": 0.0, "lower": -1.0, "upper": 1.0}]
    schedules = {f"{kind}_limit_schedules": [{"joint": "joint_9", "limits": limits}]}
    path = write(tmp_path, generators={f"{kind}_limits": {}}, **schedules)
    with pytest.raises(UnknownName, match=r"joint in a schedule .* 'joint_9'; known: joint_1, "):
        make_plan(load_scenario(path), RunOptions(), tmp_path)


@pytest.mark.parametrize(
    ("contacts", "known"), [([], "none"), ([TOOL, TOOL | {"name": "hand"}], "tool, hand")]
)
def test_a_schedule_of_a_contact_that_the_robot_has_not_starts_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], contacts: list[object], known: str
) -> None:
    """One line with what was given and the contacts of the robot as the scenario changes it."""
    path = write(tmp_path, **SCHEDULED, robot_changes={"contacts": contacts})
    assert experiment.main(["--scenario", path, "--output", str(tmp_path / "results")]) == 2
    assert capsys.readouterr().err == (
        f"experiment: unknown contact in a schedule of scenario 'mine' 'nose'; known: {known}\n"
    )
    assert not (tmp_path / "results").exists()


def test_a_contact_that_the_scenario_adds_may_have_a_schedule(tmp_path: Path) -> None:
    changes = {"contacts": [TOOL | {"name": "nose"}]}
    scenario = load_scenario(write(tmp_path, **SCHEDULED, robot_changes=changes))
    assert make_plan(scenario, RunOptions(), tmp_path).changes == changes


def test_a_reference_of_a_task_that_the_robot_has_not_is_refused(tmp_path: Path) -> None:
    file = write(tmp_path, references={"hnad": {"position": [0.4, 0.0, 0.5]}})
    with pytest.raises(
        UnknownName, match=r"task in a reference of scenario .*'hnad'; known: end_"
    ):
        make_plan(load_scenario(file), RunOptions(), tmp_path / "results")


def test_a_variant_changes_what_it_names_and_nothing_beside(tmp_path: Path) -> None:
    controller = {"velocity_limit": 1.2, "regularization": 0.01}
    path = write(
        tmp_path,
        parameters={"controller": controller, "sim_bridge": {"disturbance_push": 30.0}},
        references={"a": {"position": [0.1]}, "b": {"position": [0.2]}},
        variants={
            "plain": {},
            "slow": {
                "parameters": {"controller": {"velocity_limit": 0.3}, "sim_bridge": None},
                "references": {"b": {"position": [0.5]}},
                "phases": [{"hierarchy": "b > a"}],
            },
        },
    )
    plain, slow = load_scenario(path), load_scenario(path, "slow")
    assert plain.parameters["controller"] == controller
    assert slow.parameters == {"controller": controller | {"velocity_limit": 0.3}}
    assert [reference.task for reference in slow.references] == ["a", "b"]
    assert slow.references[0] == plain.references[0]
    assert slow.references[1] != plain.references[1]
    assert [phase.hierarchy for phase in slow.phases] == ["b > a"]


def test_every_variant_of_foot_lift_is_pushed_where_its_scenario_says() -> None:
    for variant in load_scenario("foot_lift").variants:
        parameters = load_scenario("foot_lift", variant).parameters["sim_bridge"]
        assert parameters["disturbance_push_frame"] == "chest"


@pytest.mark.parametrize(
    ("node", "values", "words"),
    [
        ("sim_bridge", {"watchdog_timeout": 0.0}, "watchdog_timeout: a number above 0 expected"),
        ("sim_bridge", {"lossless": "yes"}, "lossless: true or false expected, 'yes' given"),
        ("sim_bridge", {"publish_contact": True}, "publish_contact: unknown field; known: "),
        ("recorder", {"fast_rate": -1.0}, r"fast_rate: a number in \[0.001, .* expected, -1"),
        ("recorder", {"record_mode": "some"}, "record_mode: 'some' given; known: decimated, full"),
        ("viewer", {"display": "wall"}, "display: 'wall' given; known: auto, window, browser"),
        ("controller", {"velocity_horizon": 0.0}, "velocity_horizon: a number above 0 expected"),
    ],
)
def test_parameters_of_every_node_are_checked_when_the_file_is_read(
    tmp_path: Path, node: str, values: dict[str, object], words: str
) -> None:
    with pytest.raises(ConfigurationError, match=rf"mine.yaml: parameters.{node}.{words}"):
        load_scenario(write(tmp_path, parameters={node: values}))
