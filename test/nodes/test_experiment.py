"""`experiment` end to end: installed executables as processes over DDS, on short scenarios."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from ghc_controller.hierarchy.distance_share import DistanceShare
from ghc_sim_bridge.logs.full_rate_log import FullRateLog, Source
from ghc_sim_bridge.recorder.bag_reading import read_messages
from ghc_sim_bridge.scenario.scenario import find_scenario, scenario_names

pytestmark = pytest.mark.timeout(700)

DURATION = 1.3  # [s] simulated: two phases of 0.5 s and 0.3 s of transition
SCENARIO: dict[str, Any] = {
    "name": "short",
    "title": "A short run",
    "robot": "kuka_lwr",
    "scene": "kuka_lwr",
    "transition": 0.3,
    "hold": 0.5,
    "torque_rate_limit": 0.0,
    "references": {"end_effector": {"position": [0.4, 0.1, 0.45]}},
    "phases": [
        {"hierarchy": "posture > elbow > end_effector"},
        {"hierarchy": "end_effector > elbow > posture", "paper": {"ghc": {"end_effector": 0.0}}},
    ],
    "paper": {"source": "none"},
}
FILES = {
    "summary.json",
    "recording",
    "log.npz",
    "parameters.yaml",
    "tasks.png",
    "joints.png",
    "jerk.png",
}
START_DEADLINE = 180.0  # [s]
END_DEADLINE = 300.0  # [s] wall, of a whole run
EXIT = 90.0  # [s] wall, for an end without a run


class Experiment:
    """Runs `experiment` on a scenario in a folder of the test."""

    def __init__(self, start_node: Callable[..., Any], folder: Path) -> None:
        self._start_node = start_node
        self.folder = folder

    def start(self, *options: str, **changes: object) -> Any:
        """Start it on the short scenario with some fields changed."""
        file = self.folder / "short.yaml"
        file.write_text(yaml.safe_dump(SCENARIO | changes), encoding="utf-8")
        return self._start_node(
            "ghc_sim_bridge",
            "experiment",
            "--scenario",
            file,
            *(() if "--output" in options else ("--output", self.folder / "results")),
            *options,
        )

    def run(self, *options: str, **changes: object) -> str:
        """Run it to its end, which must be a good one; what it printed."""
        node = self.start(*options, **changes)
        assert node.wait(END_DEADLINE) == 0, node.output
        return str(node.output)

    def result(self, variant: str = "cascade") -> Path:
        """Folder of a variant."""
        return self.folder / "results" / "short" / variant

    def children(self) -> list[str]:
        """Command lines of the nodes of this test that still run."""
        mark = str(self.result("")).encode()
        found = []
        for process in Path("/proc").iterdir():
            if process.name.isdigit():
                try:
                    line = (process / "cmdline").read_bytes()
                except OSError:
                    continue  # ended meanwhile
                if mark in line and b"parameters.yaml" in line:
                    found.append(line.replace(b"\0", b" ").decode())
        return found

    def wait_until_running(self, node: Any) -> None:
        """Until time runs: the first line of progress."""
        node.wait_for_output("s simulated (", START_DEADLINE)


@pytest.fixture
def experiment(start_node: Callable[..., Any], tmp_path: Path) -> Experiment:
    """An experiment of one's own."""
    return Experiment(start_node, tmp_path)


def test_a_run_leaves_summary_figures_and_recording(experiment: Experiment) -> None:
    output = experiment.run()
    assert {entry.name for entry in experiment.result().iterdir()} >= FILES
    # The default variant can be read one folder higher as well.
    summary = json.loads((experiment.result().parent / "summary.json").read_text())
    assert summary == json.loads((experiment.result() / "summary.json").read_text())
    assert summary["sim_seconds"] == pytest.approx(DURATION)
    assert set(summary["nodes"]) >= {"sim_bridge", "controller", "recorder"}
    assert set(summary["nodes"].values()) == {0}
    assert [(p["hierarchy"], p["t_start"], p["t_end"]) for p in summary["phases"]] == [
        ("posture > elbow > end_effector", 0.0, 0.5),
        ("end_effector > elbow > posture", 0.5, DURATION),
    ]
    assert summary["qp_failures"] == summary["fallback_ticks"] == 0
    assert (
        summary["phases"][1]["errors"]["end_effector"]
        < (summary["phases"][0]["errors"]["end_effector"])
    )
    for phase in summary["phases"]:
        assert phase["hierarchy"] in output


def test_two_lockstep_runs_are_the_same_and_their_transition_comes_at_its_time(
    experiment: Experiment,
) -> None:
    logs = []
    for _ in range(2):
        experiment.run()
        logs.append(FullRateLog.load(experiment.result() / "log.npz"))
    log, again = logs
    np.testing.assert_allclose(log.q, again.q, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(log.torque, again.torque, rtol=0.0, atol=1e-9)
    assert len(log.time) == round(DURATION / log.control_dt)
    assert (log.source == Source.COMMAND).all()
    times, alphas = [], []
    channels = set()
    for topic, _, message in read_messages(experiment.result() / "recording"):
        channels.add(topic)
        if topic == "/ghc/controller_state":
            times.append(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)
            alphas.append(message.alpha[1])  # of the end effector with respect to the elbow
    assert channels >= {
        "/joint_states",
        "/joint_commands",
        "/ghc/priority_transition",
        "/ghc/task_reference",
        "/ghc/transition_status",
    }
    progress = np.clip((np.array(times) - 0.5) / 0.3, 0.0, 1.0)
    np.testing.assert_allclose(alphas, 0.5 + 0.5 * np.cos(np.pi * progress), atol=1e-9)


@pytest.mark.long
def test_priorities_follow_a_distance_where_the_scenario_says_so(experiment: Experiment) -> None:
    """The hand is released as the elbow's gap falls: minimum jerk from 70 to 45 mm, 30 ms late."""
    given = yaml.safe_load(find_scenario("avoidance_distance").read_text(encoding="utf-8"))
    given["phases"][0]["hold"] = 2.2
    experiment.run(**given | {"name": "short"})
    shares, wanted = [], []
    share = DistanceShare(given["priority_share"]["begins"], given["priority_share"]["ends"])
    for topic, _, message in read_messages(experiment.result() / "recording"):
        if topic == "/ghc/controller_state":
            errors = {task.name: task.error for task in message.tasks}
            mixed = zip(message.mixture, message.shares, strict=True)
            shares.append(sum(part for text, part in mixed if " hand >" not in text))
            wanted.append(share.wanted(errors["elbow_avoidance"][0]))
    assert max(shares) > 0.3
    assert np.abs(np.array(shares[3:]) - wanted[:-3]).mean() < 0.02
    summary = json.loads((experiment.result() / "summary.json").read_text())
    assert summary["nodes"]["priority_share"] == 0


@pytest.mark.long
def test_two_experiments_at_once_are_those_of_each_alone(
    experiment: Experiment, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each in a domain and a folder of its own, then the first one again, into its folder."""
    monkeypatch.delenv("ROS_DOMAIN_ID")
    both = [experiment.start(), experiment.start("--formulation", "hqp")]
    for node in both:
        assert node.wait(END_DEADLINE) == 0, node.output
    at_once = {
        name: FullRateLog.load(experiment.result(name) / "log.npz") for name in ("cascade", "hqp")
    }
    (experiment.result() / "left_over").touch()
    experiment.run()
    assert not (experiment.result() / "left_over").exists()
    experiment.run("--formulation", "hqp")
    for name, log in at_once.items():
        alone = FullRateLog.load(experiment.result(name) / "log.npz")
        np.testing.assert_allclose(log.q, alone.q, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(log.torque, alone.torque, rtol=0.0, atol=1e-9)
    assert np.abs(at_once["cascade"].torque - at_once["hqp"].torque).max() > 1.0


def test_a_matrix_and_changed_gains_reach_the_controller(experiment: Experiment) -> None:
    alpha = [[0.0, 0.2, 0.0], [0.8, 0.0, 0.0], [1.0, 1.0, 0.0]]
    phase = {"tasks": ["end_effector", "elbow", "posture"], "alpha": alpha}
    gains = {"tasks": {"elbow": {"stiffness": 60.0}}}
    experiment.run("--formulation", "ghc", phases=[phase], robot_changes=gains)
    folder = experiment.result("ghc")
    robot = yaml.safe_load((folder / "robot.yaml").read_text())
    assert [task["stiffness"] for task in robot["tasks"]] == [30.0, 60.0, 30.0]
    matrices = read_messages(folder / "recording", "ghc_msgs/msg/PriorityMatrix")
    last = [message for _, _, message in matrices][-1]
    np.testing.assert_allclose(last.alpha, np.ravel(alpha))
    assert not (folder.parent / "summary.json").exists()  # not the default variant


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--formulation", "magic"), ("magic", "cascade", "hqp")),
        (("--transition", "-1"), ("-1", "at least 0")),
        (("--torque-rate", "50", "--formulation", "hqp"), ("50 Nm/s", "'hqp'", "cascade")),
        (("--param", "controller=1"), ("controller=1", "node:name:=value")),
    ],
)
def test_a_wrong_option_is_one_clear_line_and_exit_code_2(
    experiment: Experiment, options: tuple[str, ...], words: tuple[str, ...]
) -> None:
    node = experiment.start(*options)
    assert node.wait(EXIT) == 2
    assert len(node.output.strip().splitlines()) == 1
    assert all(word in node.output for word in words)


def test_an_unknown_scenario_lists_the_existing_ones(start_node: Callable[..., Any]) -> None:
    node = start_node("ghc_sim_bridge", "experiment", "--scenario", "no_such_one")
    assert node.wait(EXIT) == 2
    known = ", ".join(scenario_names())
    assert "priority_switching" in known
    assert node.output.strip() == (f"experiment: unknown scenario 'no_such_one'; known: {known}")


def test_a_rejected_transition_ends_the_run_with_the_reason(experiment: Experiment) -> None:
    phases = [SCENARIO["phases"][0], {"hierarchy": "end_effector > knee"}]
    node = experiment.start(phases=phases)
    assert node.wait(START_DEADLINE) == 1
    assert "knee" in node.output and "posture" in node.output
    assert "Traceback" not in node.output
    assert experiment.children() == []


def test_the_death_of_a_node_is_reported_at_once_with_its_last_words(
    experiment: Experiment,
) -> None:
    node = experiment.start(hold=60.0)
    experiment.wait_until_running(node)
    controller = next(line for line in experiment.children() if "/controller " in line)
    os.kill(_process_id(controller), signal.SIGKILL)
    assert node.wait(EXIT) == 1
    assert "node 'controller' ended with signal SIGKILL" in node.output
    assert ": ready" in node.output  # what the controller said last
    assert experiment.children() == []


def test_a_second_experiment_leaves_the_first_one_alone_and_ctrl_c_ends_that(
    experiment: Experiment, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In its folder or its domain it is refused in one line, before it touches anything."""
    node = experiment.start(hold=60.0)
    experiment.wait_until_running(node)
    running = experiment.children()
    assert len(running) >= 3
    before = (experiment.result() / "parameters.yaml").stat()
    domain = os.environ["ROS_DOMAIN_ID"]
    monkeypatch.delenv("ROS_DOMAIN_ID")
    second = experiment.start(hold=60.0)
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    third = experiment.start("--output", str(experiment.folder / "elsewhere"), hold=60.0)
    for late, words in ((second, "is being written by"), (third, f"ROS_DOMAIN_ID={domain}")):
        assert late.wait(EXIT) == 1
        (line,) = late.output.strip().splitlines()
        assert "another experiment" in line
        assert words in line
    assert experiment.children() == running
    after = (experiment.result() / "parameters.yaml").stat()
    assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    node.send(signal.SIGINT)
    assert node.wait(EXIT) == 130, node.output
    assert "Traceback" not in node.output
    assert experiment.children() == []


def _process_id(command: str) -> int:
    for process in Path("/proc").iterdir():
        if process.name.isdigit():
            try:
                line = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode()
            except OSError:
                continue
            if line == command:
                return int(process.name)
    raise AssertionError(f"no process {command}")
