"""One run: nodes as processes, scripted messages, waiting for the end, and the results."""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import rclpy
import yaml
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor

from ghc_controller.robot.library import find_robot
from ghc_controller.robot.urdf import find_urdf
from ghc_controller.ros.this_host import stay_on_this_host
from ghc_controller.schema.reader import read_yaml
from ghc_sim_bridge.logs.controller_trace import ControllerTrace
from ghc_sim_bridge.ros.experiment_client import ExperimentClient
from ghc_sim_bridge.ros.experiment_driver import ExperimentDriver
from ghc_sim_bridge.ros.experiment_nodes import executable_of
from ghc_sim_bridge.run.cpu_placement import Cpus, lockstep_placement
from ghc_sim_bridge.run.domain import DomainLock
from ghc_sim_bridge.run.folder_lock import folder_lock
from ghc_sim_bridge.run.processes import NodeProcesses
from ghc_sim_bridge.scenario.home import mark_home
from ghc_sim_bridge.scenario.plan import RunPlan
from ghc_sim_bridge.scenario.robot_changes import write_changed_robot


@dataclass(frozen=True, slots=True)
class RunOutcome:
    """Results of a run, in addition to the files of its folder."""

    exit_codes: Mapping[str, int | None]
    wall_seconds: float  # from the release of time to the last state
    trace: ControllerTrace
    robot: Path  # robot file that the controller read
    log: Path  # the bridge's full-rate log


def run_experiment(plan: RunPlan) -> RunOutcome:
    """Run one plan over DDS; everything that is written goes to plan.folder.

    Raises GhcError (a node died, a transition was rejected, something did not come in time,
    another experiment writes the folder, or runs in the domain that ROS_DOMAIN_ID names).
    """
    with folder_lock(plan.folder):
        return _run(plan)


def _run(plan: RunPlan) -> RunOutcome:
    robot = _prepare_folder(plan)
    domain = DomainLock(alone=True)
    stay_on_this_host()
    os.environ["ROS_LOG_DIR"] = str(plan.folder / "logs")
    environment = os.environ | {"ROS_DOMAIN_ID": str(domain.id)}
    try:
        with NodeProcesses(plan.folder / "logs", environment, _placement(plan, domain)) as nodes:
            for name in plan.parameters:
                parameters = ("--params-file", str(plan.folder / "parameters.yaml"))
                arguments = ["--ros-args", "-r", f"__node:={name}", *parameters]
                nodes.start(name, *executable_of(name), arguments)
            wall_seconds, trace = _drive(plan, nodes, domain.id)
            nodes.stop()
            exit_codes = nodes.exit_codes()
    finally:
        domain.release()
    return RunOutcome(exit_codes, wall_seconds, trace, robot, plan.folder / "log.npz")


def _placement(plan: RunPlan, domain: DomainLock) -> dict[str, Cpus]:
    """By the wall clock nodes run at the same time: Linux places them."""
    return (
        {} if plan.options.mode != "lockstep" else lockstep_placement(plan.parameters, domain.id)
    )


def _prepare_folder(plan: RunPlan) -> Path:
    """Make an empty folder with the parameters of all nodes; the robot file to be used."""
    robot = find_robot(str(plan.parameters["controller"]["robot"]))
    find_urdf(read_yaml(robot).value("urdf"), robot)  # report a missing model first
    if plan.folder.exists():
        shutil.rmtree(plan.folder)
    mark_home(plan.scenario, plan.folder.parent)
    (plan.folder / "logs").mkdir(parents=True)
    parameters: dict[str, dict[str, Any]] = {
        node: dict(values) for node, values in plan.parameters.items()
    }
    if plan.changes:
        robot = write_changed_robot(robot, plan.changes, plan.folder / "robot.yaml")
        for values in parameters.values():
            if "robot" in values:
                values["robot"] = str(robot)
    content = {node: {"ros__parameters": values} for node, values in parameters.items()}
    text = yaml.safe_dump(content, sort_keys=False)
    (plan.folder / "parameters.yaml").write_text(text, encoding="utf-8")
    return robot


def _drive(plan: RunPlan, nodes: NodeProcesses, domain: int) -> tuple[float, ControllerTrace]:
    context = Context()
    rclpy.init(args=[], context=context, domain_id=domain)
    client = ExperimentClient(context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(client)
    try:
        driver = ExperimentDriver(plan, nodes, client, executor)
        driver.wait_for_nodes()
        driver.send_script()
        return driver.run(), client.trace
    finally:
        executor.shutdown()
        client.destroy_node()
        rclpy.shutdown(context=context)
