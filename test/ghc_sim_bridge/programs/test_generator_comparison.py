"""Comparison of runs without and with generators, on logs that are made up here."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml

from ghc_controller.errors import ConfigurationError, InvalidValue, UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_sim_bridge.analysis.analysis import analyse
from ghc_sim_bridge.analysis.generator_analysis import GeneratorAnalysis, analyse_generators
from ghc_sim_bridge.analysis.generator_metrics import (
    event_peaks,
    event_windows,
    force_following,
    ratios,
)
from ghc_sim_bridge.analysis.obstacle_distance import obstacle_distance
from ghc_sim_bridge.figures.generators import generator_figure
from ghc_sim_bridge.figures.style import save_png
from ghc_sim_bridge.figures.ways import ways_figure
from ghc_sim_bridge.logs.constraint_series import ConstraintSeries, ConstraintTrace
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.programs.generator_comparison import (
    comparison,
    comparison_folder,
    comparison_table,
)
from ghc_sim_bridge.programs.ways_comparison import joint_rates, way_name, ways_data, ways_table
from ghc_sim_bridge.scenario.plan import RunOptions
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario
from ghc_sim_bridge.scenario.schedules import Event
from ghc_sim_bridge.scene.values import Obstacle, Sighting

DT = 1e-3
JOINTS = tuple(f"joint_{k}" for k in range(1, 8))
ROBOT = find_robot("kuka_lwr")


def made_up_log(duration: float, steps: dict[float, float], force: Any = None) -> FullRateLog:
    """An arm at rest whose first torque steps by `steps` [Nm] at their times [s]."""
    time = np.arange(round(duration / DT)) * DT
    zeros = np.zeros((len(time), len(JOINTS)))
    torque = zeros.copy()
    for at, size in steps.items():
        torque[time > at - 0.5 * DT, 0] += size
    wrench = np.zeros((len(time), 6))
    if force is not None:
        wrench[:, 2] = force(time)
    return FullRateLog(
        time,
        zeros + 0.5,
        zeros,
        zeros,
        torque,
        torque,
        np.zeros(len(time), np.uint8),
        np.zeros(len(time), np.uint32),
        np.full(len(time), DT),
        {"tool": wrench},
        JOINTS,
        DT,
    )


def report(**fields: Any) -> Any:
    """What is read of a ControllerState."""
    empty: dict[str, Any] = {
        "contacts": [],
        "obstacles": [],
        "bounds": [],
    }
    return SimpleNamespace(**(empty | fields))


def bounded(upper: float, asked: float, lower: float = 0.0, on: bool = True) -> Any:
    bounds = {"lower": lower, "upper": upper, "force": asked}
    return report(contacts=[SimpleNamespace(name="tool", planned=True, on=on, **bounds)])


def threatened(position: list[float], velocity: list[float]) -> Any:
    entry = SimpleNamespace(
        id="wall",
        protected_frame="tool",
        position=position,
        velocity=velocity,
        acceleration=[0.0, 0.0, 0.0],
        normal=[-1.0, 0.0, 0.0],
        safe_distance=0.2,
    )
    return report(obstacles=[entry])


def test_windows_reach_to_both_sides_and_never_overlap() -> None:
    rng = np.random.default_rng(5)
    for _ in range(100):
        times = np.sort(rng.uniform(0.0, 20.0, rng.integers(1, 6)))
        events = [Event(float(time), "jump") for time in times]
        windows = event_windows(events, 20.0)
        for (start, end), event in zip(windows, events, strict=True):
            assert max(0.0, event.time - 2.0) <= start <= event.time <= end <= event.time + 2.0
        assert all(a[1] <= b[0] for a, b in itertools.pairwise(windows))


def test_the_peak_of_each_event_is_its_own_step_over_the_period() -> None:
    log = made_up_log(12.0, {0.1: 9.0, 5.0: 2.0, 6.0: -3.0})
    windows = event_windows([Event(5.0, "a"), Event(6.0, "b"), Event(9.0, "c")], 12.0)
    np.testing.assert_allclose(event_peaks(log, windows), [2000.0, 3000.0, 0.0])
    assert ratios((10.0, 1.0), (1.0, 0.0)) == (10.0, float("inf"))


def test_a_force_is_compared_with_the_sample_after_the_state_that_it_answered() -> None:
    """Asked for 10 + 100 t at every step, sensed a period later and 0.5 N larger."""
    log = made_up_log(1.0, {}, lambda t: 10.0 + 100.0 * (t - DT) + 0.5)
    trace = ConstraintTrace()
    for time in log.time[:-1]:
        trace.append(float(time), bounded(60.0, 10.0 + 100.0 * float(time)))
    result = force_following(trace.series(), "tool", log.time, log.wrenches["tool"][:, 2])
    assert result.difference_largest == pytest.approx(0.5)
    assert result.difference_rms == pytest.approx(0.5)
    assert result.qp_violation == pytest.approx(10.0 + 99.8 - 60.0)
    assert result.above_upper == pytest.approx(result.qp_violation + 0.5)


def test_without_a_contact_nothing_has_to_be_followed() -> None:
    log = made_up_log(0.1, {}, lambda t: 3.0 + 0.0 * t)
    trace = ConstraintTrace()
    for time in log.time:
        trace.append(float(time), bounded(0.0, 0.0))
    result = force_following(trace.series(), "tool", log.time, log.wrenches["tool"][:, 2])
    assert result.difference_largest == result.above_upper == result.qp_violation == 0.0


def test_a_contact_that_is_planned_but_not_felt_has_a_force_of_zero_within_its_bounds() -> None:
    """The plan asks for 2 N and allows 20 N; the foot has not met the floor."""
    log = made_up_log(0.1, {}, lambda t: 0.0 * t)
    trace = ConstraintTrace()
    for time in log.time:
        trace.append(float(time), bounded(20.0, 0.0, lower=2.0, on=False))
    result = force_following(trace.series(), "tool", log.time, log.wrenches["tool"][:, 2])
    assert result.qp_violation == result.difference_largest == 0.0


def test_the_distance_ahead_counts_the_obstacles_speed() -> None:
    """A wall in front of the resting arm, coming with 0.3 m/s: 0.1 s later it is 3 cm closer."""
    log = made_up_log(0.1, {})
    model = load_robot_config(ROBOT).model
    model.update(log.q[0], log.v[0])
    x = float(model.frame_position(model.frame_id("tool"))[0])
    trace = ConstraintTrace()
    for time in log.time[::10]:
        trace.append(float(time), threatened([x + 0.25, 0.0, 0.0], [-0.3, 0.0, 0.0]))
    track = (Sighting(0.0, (x + 0.19, 0.0, 0.0)), Sighting(0.0495, None))
    wall = Obstacle("wall", "tool", 0.2, (-1.0, 0.0, 0.0), track)
    history = obstacle_distance(trace.series(), wall, log, model, 0.1)
    np.testing.assert_allclose(history.virtual, 0.25)
    np.testing.assert_allclose(history.predicted, 0.22, atol=1e-9)
    np.testing.assert_allclose(history.actual[:5], 0.19)
    assert np.isnan(history.actual[5:]).all(), "not seen any more"
    assert history.time_inside == pytest.approx(0.05)
    assert history.violation == history.closest == 0.0
    further = obstacle_distance(trace.series(), wall, log, model, 0.2)
    assert further.violation == pytest.approx(0.2 - 0.19)


def test_the_distance_of_a_robot_whose_base_floats_grows_with_its_base() -> None:
    """Joints at rest, the base is pulled away from an obstacle at rest."""
    model = RobotModel.from_urdf(load_robot_config(ROBOT).urdf, floating_base=True)
    rows, dt = 20, 0.01
    time = np.arange(rows) * dt
    zeros = np.zeros((rows, len(JOINTS)))
    base = np.zeros((rows, 7))
    base[:, 0], base[:, 6] = -0.5 * 9.81 * time**2, 1.0
    velocity = np.zeros((rows, 6))
    velocity[:, 0] = -9.81 * time
    log = replace(made_up_log(rows * DT, {}), time=time, control_dt=dt, base_pose=base)
    log = replace(log, q=zeros, v=zeros, base_velocity=velocity)
    model.update(log.configuration(0, model.joint_names), log.velocity(0, model.joint_names))
    start = model.frame_position(model.frame_id("tool")).copy()
    place = start + [0.2, 0.0, 0.0]
    trace = ConstraintTrace()
    for instant in time[:10]:
        trace.append(float(instant), threatened(place.tolist(), [0.0, 0.0, 0.0]))
    wall = Obstacle("wall", "tool", 0.2, (-1.0, 0.0, 0.0), (Sighting(0.0, tuple(place)),))
    history = obstacle_distance(trace.series(), wall, log, model, 0.1)
    np.testing.assert_allclose(history.actual, 0.2 + 0.5 * 9.81 * time[:10] ** 2)
    later = time[:10] + 0.1
    np.testing.assert_allclose(history.predicted, 0.2 + 0.5 * 9.81 * later**2, rtol=1e-6)


def test_a_series_is_what_was_reported_and_survives_its_file(tmp_path: Path) -> None:
    trace = ConstraintTrace()
    trace.append(0.0, report())
    trace.append(0.1, bounded(7.0, 3.0))
    trace.append(0.2, threatened([1.0, 2.0, 3.0], [0.0, 0.0, 0.0]))
    trace.series().save(tmp_path / "constraints.npz")
    series = ConstraintSeries.load(tmp_path / "constraints.npz")
    assert not series.is_empty
    np.testing.assert_array_equal(series.contacts["tool"][1], [0.0, 7.0, 3.0])
    assert np.isnan(series.contacts["tool"][[0, 2]]).all()
    assert series.obstacles["wall"][2, :3].tolist() == [1.0, 2.0, 3.0]
    assert series.frames == {"wall": "tool"}
    with pytest.raises(ConfigurationError, match=r"nothing\.npz"):
        ConstraintSeries.load(tmp_path / "nothing.npz")


def made_up_run(
    folder: Path, scenario: str, on: bool, sizes: float, normal: Any = (0.0, 0.0, 1.0)
) -> GeneratorAnalysis:
    """A run whose torque steps by `sizes` [Nm] at every event of the scenario."""
    plan = make_plan(load_scenario(scenario), RunOptions(generators=on), folder)
    plan.folder.mkdir(parents=True)
    (plan.folder / "robot.yaml").write_text(
        yaml.safe_dump({"contacts": [{"name": "tool", "normal": normal}]}), encoding="utf-8"
    )
    log = made_up_log(
        plan.duration, {event.time: sizes for event in plan.scenario.events}, lambda t: 10.0 + t
    )
    columns = {
        name: getattr(log, name)
        for name in ("time", "q", "v", "acceleration", "torque", "commanded")
        + ("source", "epoch", "cycle_time", "joint_names", "control_dt")
    }
    np.savez(plan.folder / "log.npz", wrench_tool=log.wrenches["tool"], **columns)
    trace = ConstraintTrace()
    for time in np.arange(0.0, plan.duration, 0.1):
        force = "force" in scenario
        trace.append(
            float(time), bounded(30.0, 20.0) if force else threatened([1.0, 0, 0], [0.0, 0, 0])
        )
    return analyse_generators(analyse(plan, plan.folder / "log.npz", ROBOT), trace.series())


SUMMARY = {
    "real_time_factor": 1.25,
    "limit_violations": {"torque": 0.0},
    "qp_failures": 0,
    "fallback_ticks": 0,
    "torque_rate_limit_nm_per_s": None,
}


@pytest.mark.parametrize("scenario", ["force_bound_step", "obstacle_jump"])
def test_a_comparison_has_the_ratio_of_every_event(tmp_path: Path, scenario: str) -> None:
    off, on = (made_up_run(tmp_path, scenario, side, 5.0 - 4.5 * side) for side in (False, True))
    data = comparison(off, on, (SUMMARY, SUMMARY))
    assert len(data["events"]) == len(on.analysis.plan.scenario.events) == 4
    for event in data["events"]:
        assert event["ratio"] == pytest.approx(10.0)
        assert event["peak_torque_rate_nm_per_s"] == {"off": 5000.0, "on": 500.0}
    assert data["smallest_ratio"] == pytest.approx(10.0)
    bounds = data["contacts"]["tool"] if "force" in scenario else data["obstacles"]["wall"]
    assert set(bounds) == {"off", "on"}
    table = comparison_table(data)
    assert all(event["name"] in table for event in data["events"])
    assert "@ 1 ms" in table and "10.0" in table
    assert comparison_folder(on.analysis.plan) == tmp_path / scenario
    save_png(generator_figure(off, on), tmp_path / "figure.png")
    assert 10_000 < (tmp_path / "figure.png").stat().st_size < 250_000


def test_no_rate_at_all_with_generators_is_no_ratio(tmp_path: Path) -> None:
    off, on = (made_up_run(tmp_path, "force_bound_step", s, 1.0 - s) for s in (False, True))
    data = comparison(off, on, (SUMMARY, SUMMARY))
    assert data["smallest_ratio"] is None
    assert "–" in comparison_table(data)


def test_other_pairs_are_compared_in_a_folder_of_their_own(tmp_path: Path) -> None:
    options = RunOptions(generators=True, control_dt=0.002)
    plan = make_plan(load_scenario("force_bound_step"), options, tmp_path)
    assert comparison_folder(plan).name == "cascade-generators_both-dt_0.002s"
    assert comparison_folder(replace(plan, is_default=True)) == plan.folder.parent


def test_watched_joints_have_their_own_peaks() -> None:
    """The first joint steps by 2 Nm at 5 s and by 9 Nm outside of the window, no other moves."""
    log = made_up_log(8.0, {0.5: 9.0, 5.0: 2.0})
    rates = joint_rates(log, ["joint_1", "joint_2"], [(4.0, 6.0)])
    assert rates.events == pytest.approx((2.0 / DT,))
    assert rates.run == pytest.approx(9.0 / DT)
    assert joint_rates(log, ["joint_2"], [(4.0, 6.0)]).run == 0.0
    with pytest.raises(UnknownName, match="nose"):
        joint_rates(log, ["nose"], [])


def test_ways_stand_beside_each_other_under_their_names(tmp_path: Path) -> None:
    """Smoothed bounds step by a tenth of what raw ones do."""
    runs = [made_up_run(tmp_path, "force_bound_step", s, 5.0 - 4.5 * s) for s in (False, True)]
    plan = runs[0].analysis.plan
    watching = replace(plan, scenario=replace(plan.scenario, watched_joints=("joint_1",)))
    runs[0] = replace(runs[0], analysis=replace(runs[0].analysis, plan=watching))
    ways = {way_name(run.analysis.plan): run for run in runs}
    assert list(ways) == ["raw bounds", "smoothed bounds"]
    data = ways_data(ways)
    for name, peak in (("raw bounds", 5000.0), ("smoothed bounds", 500.0)):
        way = data["ways"][name]
        assert way["watched_peak_nm_per_s"]["events"] == pytest.approx([peak] * 4)
        assert way["peak_nm_per_s"]["run"] == pytest.approx(peak)
    assert "@ 1 ms" in ways_table(data)
    save_png(ways_figure(ways), tmp_path / "ways.png")
    assert (tmp_path / "ways.png").stat().st_size > 10_000


def watching(run: GeneratorAnalysis) -> GeneratorAnalysis:
    """The run, with its scenario watching the first joint."""
    plan = run.analysis.plan
    plan = replace(plan, scenario=replace(plan.scenario, watched_joints=("joint_1",)))
    return replace(run, analysis=replace(run.analysis, plan=plan))


def test_ways_without_contact_schedules_have_no_row_of_forces(tmp_path: Path) -> None:
    """Torques and their rates; a way without a schedule beside one that has it is left blank."""
    kinds = ("force_bound_step", "obstacle_jump")
    force, jump = (watching(made_up_run(tmp_path, kind, True, 5.0)) for kind in kinds)
    figure = ways_figure({"a": jump, "b": jump})
    assert len(figure.axes) == 2 * 2
    assert [ax.get_ylabel() for ax in figure.axes[::2]] == [
        "joint torque [Nm]",
        "torque rate [Nm/s]",
    ]
    save_png(figure, tmp_path / "ways.png")
    mixed = ways_figure({"a": jump, "b": force}).axes
    assert len(mixed) == 3 * 2
    assert "contact tool" in mixed[0].get_ylabel()
    lines = [[line.get_label() for line in ax.get_lines()] for ax in mixed[:2]]
    assert ["simulated" in labels for labels in lines] == [False, True]


def test_a_force_is_taken_along_a_normal_of_any_length(tmp_path: Path) -> None:
    """Three components are needed: one number is no direction."""
    name = "force_bound_step"
    unit = made_up_run(tmp_path / "1", name, True, 5.0)
    double = made_up_run(tmp_path / "2", name, True, 5.0, (0.0, 0.0, 2.0))
    np.testing.assert_array_equal(double.forces["tool"], unit.forces["tool"])
    assert double.following == unit.following
    with pytest.raises(InvalidValue, match=r"contact 'tool': normal .* a direction expected"):
        made_up_run(tmp_path / "3", name, True, 5.0, (0.0, 0.0, 0.0))
    with pytest.raises(ConfigurationError, match=r"contacts\[0\].normal: 3 numbers expected"):
        made_up_run(tmp_path / "4", name, True, 5.0, 1.0)
