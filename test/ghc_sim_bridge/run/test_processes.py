"""Processes of a run: found, watched, ended; a domain for each; a robot file with changes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

from ghc_controller.errors import ConfigurationError, GhcError, UnknownName
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.ros.stop_signals import STOP_SIGNALS
from ghc_sim_bridge.run import processes
from ghc_sim_bridge.run.cpu_placement import lockstep_placement
from ghc_sim_bridge.run.domain import DomainLock
from ghc_sim_bridge.run.executables import find_executable
from ghc_sim_bridge.run.interrupts import INTERRUPTED
from ghc_sim_bridge.run.processes import (
    NodeProcesses,
    ProcessFailure,
    describe_exit,
)
from ghc_sim_bridge.scenario.robot_changes import write_changed_robot

SLEEPER = "import time\nprint('up', flush=True)\ntime.sleep(60)\n"
STUBBORN = "import signal\nsignal.signal(signal.SIGINT, signal.SIG_IGN)\n" + SLEEPER


@pytest.fixture
def nodes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> NodeProcesses:
    """Processes whose `executable` is the text of a Python program."""
    monkeypatch.setattr(processes, "find_executable", lambda *_: sys.executable)
    return NodeProcesses(tmp_path, os.environ)


def start(nodes: NodeProcesses, name: str, program: str) -> None:
    """Start a Python program as a node and wait for its first word."""
    nodes.start(name, "package", "executable", ["-c", program])
    deadline = time.monotonic() + 60.0
    while not nodes.log_of(name).read_bytes():
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.fixture(params=[signal.SIG_DFL, signal.SIG_IGN], ids=["default", "ignored"])
def inherited(request: pytest.FixtureRequest) -> Iterator[None]:
    """What a child inherits of both signals; nohup, cron and a background job ignore SIGINT."""
    before = {number: signal.signal(number, request.param) for number in STOP_SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("inherited")
def test_nodes_end_by_sigint_and_their_exit_codes_are_kept(nodes: NodeProcesses) -> None:
    program = "import sys, time\ntry:\n print('up', flush=True)\n time.sleep(60)\n"
    start(nodes, "polite", program + "except KeyboardInterrupt:\n sys.exit(0)\n")
    nodes.check()
    nodes.stop()
    assert nodes.exit_codes() == {"polite": 0}


def test_a_node_that_ignores_sigint_is_killed_after_a_while(nodes: NodeProcesses) -> None:
    start(nodes, "stubborn", STUBBORN)
    nodes.stop(patience=0.3)
    assert nodes.exit_codes() == {"stubborn": -signal.SIGKILL}


def test_a_dead_node_is_reported_with_its_last_lines(nodes: NodeProcesses) -> None:
    start(nodes, "ill", "import sys\nprint('line 1\\nline 2', flush=True)\nsys.exit(3)\n")
    deadline = time.monotonic() + 60.0
    while nodes.exit_codes()["ill"] is None:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    with pytest.raises(ProcessFailure, match=r"'ill' ended with exit code 3(.|\n)*line 1\nline 2"):
        nodes.check()


def test_a_node_may_end_in_order_where_that_is_allowed(nodes: NodeProcesses) -> None:
    start(nodes, "viewer", "print('bye', flush=True)\n")
    deadline = time.monotonic() + 60.0
    while nodes.exit_codes()["viewer"] is None:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    nodes.check(may_end=["viewer"])
    with pytest.raises(ProcessFailure):
        nodes.check()


@pytest.mark.usefixtures("inherited")
def test_a_node_is_ended_in_the_middle_of_its_start(nodes: NodeProcesses) -> None:
    """Before it has handlers of its own: a SIGINT that comes then is not lost."""
    nodes.start("early", "package", "executable", ["-c", SLEEPER])
    nodes.stop(patience=60.0)
    assert nodes.exit_codes()["early"] not in (None, -signal.SIGKILL)


@pytest.mark.usefixtures("inherited")
@pytest.mark.parametrize("number", STOP_SIGNALS)
def test_a_command_is_interrupted_whatever_it_inherited(number: signal.Signals) -> None:
    code = (
        "import sys, time\nfrom ghc_sim_bridge.run.interrupts import interruptible\n"
        "sys.exit(interruptible('job', lambda: print('up', flush=True) or time.sleep(60)))"
    )
    command = [sys.executable, "-c", code]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.readline() == "up\n"
        process.send_signal(number)
        assert process.wait(60.0) == INTERRUPTED
        assert process.stderr.read() == "job: interrupted; all nodes were ended\n"


def test_leaving_the_context_ends_all_nodes_also_after_an_error(nodes: NodeProcesses) -> None:
    with pytest.raises(RuntimeError), nodes:
        start(nodes, "one", SLEEPER)
        raise RuntimeError
    assert nodes.exit_codes()["one"] is not None


def test_a_missing_package_or_executable_says_what_exists() -> None:
    with pytest.raises(GhcError, match=r"'no_such_package' is not in the ament index"):
        find_executable("no_such_package", "experiment")
    with pytest.raises(UnknownName, match="experiment"):
        find_executable("ghc_sim_bridge", "no_such_executable")


def test_exit_codes_are_told_in_words() -> None:
    assert describe_exit(2) == "exit code 2"
    assert describe_exit(-9) == "signal SIGKILL"


def test_two_runs_get_two_domains_and_a_given_one_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    first, second = DomainLock(), DomainLock()
    assert first.id != second.id
    assert {first.id, second.id} <= set(range(1, 102))
    first.release()
    second.release()
    monkeypatch.setenv("ROS_DOMAIN_ID", "77")
    assert DomainLock().id == DomainLock().id == 77
    alone = DomainLock(alone=True)
    with pytest.raises(
        GhcError, match="another experiment runs in the domain of ROS_DOMAIN_ID=77"
    ):
        DomainLock(alone=True)
    alone.release()
    DomainLock(alone=True).release()


def test_changes_of_a_robot_reach_its_tasks_and_nothing_else(tmp_path: Path) -> None:
    source = find_robot("kuka_lwr")
    changes = {"tasks": {"elbow": {"stiffness": 77.0}}, "limits": {"velocity": 0.5}}
    changed = load_robot_config(write_changed_robot(source, changes, tmp_path / "robot.yaml"))
    before = load_robot_config(source)
    stiffness = {task.name: float(task.stiffness[0]) for task in changed.tasks}
    assert stiffness == {"end_effector": 30.0, "elbow": 77.0, "posture": 30.0}
    assert (changed.model.velocity_limit == 0.5).all()
    assert (changed.model.torque_limit == before.model.torque_limit).all()
    assert changed.torque_rate == before.torque_rate
    assert changed.hierarchy == before.hierarchy


def test_wrong_changes_of_a_robot_are_refused(tmp_path: Path) -> None:
    source, target = find_robot("kuka_lwr"), tmp_path / "robot.yaml"
    with pytest.raises(UnknownName, match=r"'knee'; known: end_effector, elbow, posture"):
        write_changed_robot(source, {"tasks": {"knee": {}}}, target)
    with pytest.raises(ConfigurationError, match="mapping of changes by name"):
        write_changed_robot(source, {"tasks": ["elbow"]}, target)
    assert yaml.safe_load(source.read_text(encoding="utf-8"))["urdf"] == "kuka_lwr.urdf"


@pytest.mark.skipif(len(os.sched_getaffinity(0)) < 2, reason="one CPU leaves no choice")
def test_nodes_run_where_they_are_placed(nodes: NodeProcesses, tmp_path: Path) -> None:
    names = ("sim_bridge", "controller", "recorder")
    placement = lockstep_placement(names, 1)
    placed = NodeProcesses(tmp_path, os.environ, placement)
    for name in names:
        start(placed, name, SLEEPER)
    found = {name: os.sched_getaffinity(placed.pid_of(name)) for name in names}
    placed.stop()
    assert found == placement


def test_nodes_that_take_turns_share_a_cpu_of_their_own() -> None:
    names = ("sim_bridge", "controller", "recorder", "obstacle_bounds")
    for number in range(5):
        placement = lockstep_placement(names, number, (2, 5, 7))
        shared = placement["sim_bridge"]
        assert shared == placement["controller"] == {(2, 5, 7)[number % 3]}
        assert placement["recorder"] == placement["obstacle_bounds"] == {2, 5, 7} - shared
    assert lockstep_placement(names, 0, (3,)) == {}
