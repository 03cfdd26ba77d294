"""The documents say what the sources say: tables, topics, links, commands, the example robot."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from doc_text import DOCUMENTS, GENERATED, ROOT, anchors, blocks, commands, links

from docs.interface_tables import DOCUMENT, MESSAGES, NODES, rendered, tables
from ghc_controller.errors import UnknownName
from ghc_controller.hierarchy import matrix_from_hierarchy
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.tasks import TASKS
from ghc_sim_bridge.run.executables import find_executable

INTERFACES = DOCUMENT.read_text(encoding="utf-8")
OWN_ROBOT = ROOT / "docs" / "own_robot.md"
DEADLINE = 60.0  # [s] wall, until the nodes have shown all their topics


def rows(heading: str) -> list[list[str]]:
    """Cells of the first table below a heading of interfaces.md."""
    part = INTERFACES.split(f"## {heading}\n", 1)[1].split("\n## ", 1)[0]
    lines = [line for line in part.splitlines() if line.startswith("|")]
    return [[cell.strip(" `") for cell in line.split("|")[1:-1]] for line in lines[2:]]


def test_tables_are_those_of_the_sources() -> None:
    assert rendered(INTERFACES) == INTERFACES, "run: python docs/interface_tables.py"


def test_every_node_and_every_message_on_a_topic_has_a_table() -> None:
    described = tables(INTERFACES)
    assert {name for source, name in described if source == "parameters"} == set(NODES)
    ours = {row[1].removeprefix("ghc_msgs/msg/") for row in rows("Topics") if "ghc_msgs" in row[1]}
    parts = {name for name in ours for name in _own_parts(name)}
    assert ours | parts <= {name for source, name in described if source == "message"}


def _own_parts(message: str) -> set[str]:
    """Messages that a message is made of, in the documents so far."""
    text = (MESSAGES / f"{message}.msg").read_text(encoding="utf-8")
    return set(
        re.findall(
            r"^(?:ghc_msgs/)?(Task\w+|NamedCount|ObstacleState|ConstraintPreview|PlannedMotion|BoundInForce)\[\]",
            text,
            re.MULTILINE,
        )
    )


def test_every_executable_is_listed_and_exists() -> None:
    for package, executable, _ in rows("Executables"):
        assert find_executable(package, executable).is_file()
    for package in ("ghc_controller", "ghc_sim_bridge", "ghc_mpc_constraints"):
        with pytest.raises(UnknownName) as error:
            find_executable(package, "")
        listed = {row[1] for row in rows("Executables") if row[0] == package}
        assert listed == set(error.value.known)


def test_topics_and_services_are_those_of_running_nodes(
    ros_context: Any, start_node: Callable[..., Any]
) -> None:
    from rclpy.node import Node

    scene = ("-p", "scene:=kuka_lwr_plane", "-p", f"lockstep_timeout:={DEADLINE}")
    start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", *scene)
    mirror = ("-p", "mirror_commands:=true")
    start_node("ghc_controller", "controller", "--ros-args", "-p", "robot:=kuka_lwr", *mirror)
    start_node("ghc_controller", "reachable_targets", "--ros-args", "-p", "robot:=kuka_lwr")
    start_node("ghc_sim_bridge", "display_publisher", "--ros-args", "-p", "robot:=kuka_lwr")
    generators = ("contact_forces", "obstacle_motion", "joint_limits", "torque_limits")
    for generator in (*generators, "body_margins"):
        chosen = ("--ros-args", "-p", f"generator:={generator}")
        start_node("ghc_mpc_constraints", "generator", *chosen)
    node = Node("reader", context=ros_context)
    topics = {
        "/" + _named(row[0]).lstrip("/"): (row[1], _qos(row[3]))
        for row in rows("Topics")
        if row[0] != "odom"  # of a floating base only: see test_bridge_floating
    }
    services = {("/" + row[0], row[1]) for row in rows("Services")}
    deadline = time.monotonic() + DEADLINE
    while True:
        found = {
            name: (kinds[0], _offered(node, name))
            for name, kinds in node.get_topic_names_and_types()
            if name not in ("/rosout", "/parameter_events")
        }
        offered = {(name, kinds[0]) for name, kinds in node.get_service_names_and_types()}
        if (found == topics and services <= offered) or time.monotonic() > deadline:
            break
        time.sleep(0.2)
    node.destroy_node()
    assert found == topics
    assert services <= offered
    assert {s for s in offered if "/_" not in s[0] and s[1].startswith("std_srvs")} == services


def _named(topic: str) -> str:
    return topic.replace("<name>", "tool").replace("<task>", "end_effector")


def _qos(words: str) -> set[str]:
    """Reliability and durability of a cell."""
    reliability = "best effort" if "best effort" in words else "reliable"
    return {reliability, "transient local" if "transient local" in words else "volatile"}


def _offered(node: Any, topic: str) -> set[str]:
    """Reliability and durability of a topic's publishers; without one, of its readers."""
    ends = node.get_publishers_info_by_topic(topic) or node.get_subscriptions_info_by_topic(topic)
    profiles = [end.qos_profile for end in ends]
    policies = [profile.reliability.name for profile in profiles]
    policies += [profile.durability.name for profile in profiles]
    return {policy.lower().replace("_", " ") for policy in policies}


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(document: Path) -> None:
    for link in links(document):
        target, _, anchor = link.partition("#")
        if "://" in target:
            continue
        path = (document.parent / target).resolve() if target else document
        assert path.exists() or path in GENERATED, f"{document.name}: {link}"
        if anchor and path.exists():
            assert anchor in anchors(path), f"{document.name}: {link}"


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_make_and_python_commands_name_what_exists(document: Path) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z]+):", makefile, re.MULTILINE))
    options = set(re.findall(r"\b([A-Z]+)=", makefile)) | set(re.findall(r"\$\((\w+)\)", makefile))
    for command in commands(document):
        words = shlex.split(command)
        if words[0] == "make":
            given = [word for word in words[1:] if "=" not in word]
            assert set(given) <= targets, command
            assert {w.partition("=")[0] for w in words[1:] if "=" in w} <= options, command
        elif words[0] == "python" and words[1].endswith(".py"):
            assert (ROOT / words[1]).is_file(), command


def test_no_document_gives_a_torque_rate_without_its_control_period() -> None:
    for document in DOCUMENTS:
        for line in document.read_text(encoding="utf-8").splitlines():
            if re.search(r"\d ?Nm/s(?!²)", line):
                assert re.search(r"limit|\d ?ms", line), f"{document.name}: {line}"


def test_hierarchy_strings_of_the_tables_parse() -> None:
    tasks = load_robot_config(find_robot("kuka_lwr")).task_names
    shown = [row[0] for row in rows("Hierarchies") if ">" in row[0] or "=" in row[0]]
    assert len(shown) >= 2
    for hierarchy in shown:
        matrix_from_hierarchy(tasks, hierarchy)


def test_every_task_kind_is_described() -> None:
    described = re.findall(r"^\| `(\w+)` \|", OWN_ROBOT.read_text(encoding="utf-8"), re.MULTILINE)
    assert set(TASKS) <= set(described)


@pytest.mark.timeout(300)
def test_the_own_robot_of_the_document_runs(tmp_path: Path, ros_domain_id: int) -> None:
    for block in blocks(OWN_ROBOT):
        named = re.match(r"(?:# |<!-- )(\w+/[\w.]+)", block.text)
        if named:
            file = tmp_path / named[1]
            file.parent.mkdir(exist_ok=True)
            file.write_text(block.text, encoding="utf-8")
    scenario = next(c for c in commands(OWN_ROBOT) if c.startswith("make run")).partition("=")[2]
    run = subprocess.run(
        [find_executable("ghc_sim_bridge", "experiment"), "--scenario", scenario],
        cwd=tmp_path,
        env={**os.environ, "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert "limits exceeded: none; qp failures: 0" in run.stdout
    assert "Warning" not in run.stderr
    phase = next(line for line in run.stdout.splitlines() if " hand > posture " in line)
    assert float(phase.split()[6]) < 5e-3, "the first task is nearly met after 3 s"


def test_the_script_that_writes_the_tables_runs() -> None:
    before = DOCUMENT.read_bytes()
    code = "import runpy, sys; runpy.run_path(sys.argv[1])"  # as a module: nothing is written
    script = str(ROOT / "docs" / "interface_tables.py")
    subprocess.run([sys.executable, "-c", code, script], check=True)
    assert DOCUMENT.read_bytes() == before
