"""The nodes run what a package outside `src/` brings: its entry points are all they are told."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bridge_client import BridgeClient
from ghc_msgs.msg import ControllerState
from plugin_install import install_plugin, on_python_path
from sensor_msgs.msg import JointState

from ghc_controller.ros.qos import STREAM_QOS
from ghc_controller.ros.time import nanoseconds_from_time

pytestmark = pytest.mark.timeout(400)

ROBOT, SCENE, SCENARIO = "planar_plugin_arm", "planar_plugin_room", "planar_plugin_fold"
FORMULATION = "flat_least_squares"
BRIDGE = {"scene": SCENE, "torque_rate_limit": 0.0, "lockstep_timeout": 180.0}
START = {"shoulder": 0.2, "elbow": 0.8, "wrist": 0.5}  # [rad] as in its scene
DURATION = 1.5  # [s] simulated; the error of the task has poles at -10 1/s, twice


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the package as pip installs it."""
    return install_plugin(tmp_path_factory.mktemp("plugin"))


@pytest.fixture
def plugin(installed: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Nodes that a test starts see the package."""
    on_python_path(installed, monkeypatch)
    return installed


class Listener(BridgeClient):
    """Hears what the controller says of itself."""

    def __init__(self, context: Any) -> None:
        super().__init__(context)
        self.reports: list[ControllerState] = []
        self.node.create_subscription(
            ControllerState, "ghc/controller_state", self.reports.append, STREAM_QOS
        )


@pytest.fixture
def listener(ros_context: Any) -> Iterator[Listener]:
    """A listener on the test's own domain."""
    partner = Listener(ros_context)
    yield partner
    partner.close()


def _parameters(**values: object) -> list[str]:
    pairs = [("-p", f"{name}:={value}") for name, value in values.items()]
    return ["--ros-args", *(part for pair in pairs for part in pair)]


def _close_the_loop(
    start_node: Callable[..., Any], listener: Listener, **parameters: object
) -> None:
    """Run controller and bridge for DURATION; the listener then has states and reports of it."""
    controller = start_node(
        "ghc_controller", "controller", *_parameters(arming="automatic", **parameters)
    )
    controller.wait_for_output("ready", 300.0)
    listener.until(  # before the bridge lets time run
        lambda: listener.node.count_publishers("ghc/controller_state") > 0, "the controller"
    )
    bridge = start_node("ghc_sim_bridge", "sim_bridge", *_parameters(**BRIDGE))

    def finished() -> bool:
        assert controller.exit_code is None, controller.output
        assert bridge.exit_code is None, bridge.output
        heard = (listener.reports, listener.states)
        return all(messages and _time(messages[-1]) >= DURATION for messages in heard)

    listener.until(finished, f"a report and a state at {DURATION:g} s", 180.0)


def _time(message: ControllerState | JointState) -> float:
    return 1e-9 * nanoseconds_from_time(message.header.stamp)


@pytest.mark.parametrize("robot", [ROBOT, "planar_python_arm"])
def test_controller_and_bridge_close_the_loop_with_what_it_brings(
    robot: str, plugin: Path, start_node: Callable[..., Any], listener: Listener
) -> None:
    """Scene, robot (its folder, or written in Python), task kind and formulation by name."""
    _close_the_loop(start_node, listener, robot=robot, formulation=FORMULATION, last_share=0.5)
    first, last = listener.reports[0], listener.reports[-1]
    assert last.formulation == FORMULATION
    assert [task.name for task in last.tasks] == ["fold", "posture"]
    assert abs(first.tasks[0].error[0]) > 0.2
    assert abs(last.tasks[0].error[0]) < 1e-4
    assert abs(sum(listener.states[-1].position) - 1.2) < 1e-4
    assert all(report.status == ControllerState.SOLVED for report in listener.reports)


def test_its_constraint_and_its_contact_hold_over_dds(
    plugin: Path, start_node: Callable[..., Any], listener: Listener
) -> None:
    """The fold stops at its bound instead of its reference, with the hand at its height."""
    _close_the_loop(start_node, listener, robot="planar_guarded_arm")
    last = listener.states[-1]
    assert abs(sum(last.position) - 1.3) < 1e-3
    assert min(sum(state.position) for state in listener.states) > 1.3 - 1e-4
    height = _height(list(START), list(START.values()))
    assert abs(_height(last.name, last.position) - height) < 1e-3
    active = {row.name for report in listener.reports for row in report.rows if row.active}
    assert "guard" in active
    assert all(report.status == ControllerState.SOLVED for report in listener.reports)


def _height(names: Sequence[str], position: Sequence[float]) -> float:
    """Of the hand [m], by the lengths of the links."""
    angles = np.cumsum([position[names.index(name)] for name in ("shoulder", "elbow", "wrist")])
    return float(np.cos(angles) @ [0.4, 0.3, 0.2])


def test_its_scenario_runs_by_name(
    plugin: Path, start_node: Callable[..., Any], tmp_path: Path
) -> None:
    output = tmp_path / "results"
    run = start_node("ghc_sim_bridge", "experiment", "--scenario", SCENARIO, "--output", output)
    assert run.wait(200.0) == 0, run.output
    assert "limits exceeded: none; qp failures: 0" in run.output
    summary = json.loads((output / SCENARIO / FORMULATION / "summary.json").read_text())
    errors = [phase["errors"] for phase in summary["phases"]]
    assert np.isfinite([list(error.values()) for error in errors]).all()


def test_names_that_do_not_exist_are_rejected_with_those_of_the_package(
    plugin: Path, start_node: Callable[..., Any]
) -> None:
    for values, kind, known in (
        ({"robot": "planar_arm"}, "robot", ROBOT),
        ({"robot": ROBOT, "formulation": "flat"}, "formulation", FORMULATION),
    ):
        node = start_node("ghc_controller", "controller", *_parameters(**values))
        assert node.wait(120.0) != 0
        (line,) = [line for line in node.output.splitlines() if f"unknown {kind}" in line]
        assert known in line


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"formulation": FORMULATION, "last_share": 0}, "'last_share': a number above 0 expected"),
        ({"formulation": "cascade", "last_share": 0.5}, "unknown parameter 'last_share'"),
    ],
)
def test_settings_of_its_formulation_are_checked_and_belong_to_it_alone(
    plugin: Path, start_node: Callable[..., Any], values: dict[str, object], words: str
) -> None:
    node = start_node("ghc_controller", "controller", *_parameters(robot=ROBOT, **values))
    assert node.wait(120.0) == 2
    assert words in node.output


def test_a_package_that_cannot_be_imported_is_named(
    plugin: Path, start_node: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its own names fail with package and entry point; those of others work on."""
    broken = tmp_path / "broken" / "broken_plugin-1.0.dist-info"
    broken.mkdir(parents=True)
    (broken / "METADATA").write_text("Metadata-Version: 2.1\nName: broken-plugin\nVersion: 1.0\n")
    (broken / "entry_points.txt").write_text(
        "[ghc_controller.formulations]\nbroken = no_such_module:Formulation\n"
    )
    on_python_path(broken.parent, monkeypatch)
    node = start_node(
        "ghc_controller", "controller", *_parameters(robot=ROBOT, formulation="broken")
    )
    assert node.wait(120.0) != 0
    assert "formulation 'broken' of package broken-plugin 1.0" in node.output
    assert "broken = no_such_module:Formulation) cannot be loaded" in node.output
    assert "No module named 'no_such_module'" in node.output
    assert "Traceback" not in node.output
    node = start_node(
        "ghc_controller", "controller", *_parameters(robot=ROBOT, formulation=FORMULATION)
    )
    node.wait_for_output("ready", 300.0)


def test_the_generator_node_runs_its_generator_and_the_controller_follows_it(
    plugin: Path, start_node: Callable[..., Any], listener: Listener
) -> None:
    """A message of another package in, torque limits that move in force: no code names them."""
    controller = start_node(
        "ghc_controller",
        "controller",
        *_parameters(robot=ROBOT, arming="automatic", wait_for_bounds="[torque_limits]"),
    )
    generator = start_node(
        "ghc_mpc_constraints",
        "generator",
        *_parameters(generator="planar_plugin_derating", rate=1.0, take_over_timeout=0.0),
    )
    generator.wait_for_output("ready", 300.0)
    controller.wait_for_output("ready", 300.0)
    start_node(
        "ghc_sim_bridge",
        "sim_bridge",
        *_parameters(**BRIDGE),
    )
    joint = "shoulder"
    publisher = listener.node.create_publisher(JointState, "constraints/derating", 1)

    def limits() -> list[float]:
        return [b.upper for r in listener.reports for b in r.bounds if b.row == joint]

    def until(limit: float) -> None:
        message = JointState(name=[joint, "nobody"], effort=[limit, 1.0])

        def sent_and_seen() -> bool:
            publisher.publish(message)
            return bool(limits()) and abs(limits()[-1] - limit) < 1e-6

        listener.until(sent_and_seen, f"a limit of {limit} Nm")

    until(40.0)  # of 80 Nm; gravity takes 8, so that the arm does not fall
    until(39.5)
    bounded = [r for r in listener.reports if any(b.row == joint for b in r.bounds)]
    times = [_time(report) for report in bounded]
    steps = np.abs(np.diff(limits()))
    assert np.count_nonzero(steps > 1e-6) > 3
    assert (steps <= 1.0 * np.diff(times) + 1e-6).all(), "at 1 Nm/s, not at once"
    listener.until(lambda: "unknown joint 'nobody'" in controller.output, "the warning")
