"""Policies of DDS security: sound by the schema of sros2, and of the topics that there are."""

from __future__ import annotations

import os
import subprocess
from fnmatch import fnmatch
from pathlib import Path
from xml.etree import ElementTree

import pytest

from ghc_mpc_constraints.generator import GENERATORS

ROOT = Path(__file__).resolve().parents[2]
POLICIES = sorted((ROOT / "security" / "policies").glob("*.xml"))
# Schema of policies, version 0.2.0 (design.ros2.org, "ROS 2 Access Control Policies"; sros2's
# policy.xsd): element -> required attributes, optional attributes, children.
SCHEMA: dict[str, tuple[set[str], set[str], set[str]]] = {
    "policy": ({"version"}, set(), {"enclaves"}),
    "enclaves": (set(), set(), {"enclave"}),
    "enclave": ({"path"}, set(), {"profiles"}),
    "profiles": (set(), {"type"}, {"profile", "metadata"}),
    "profile": ({"ns", "node"}, set(), {"topics", "services", "actions"}),
    "topics": (set(), {"publish", "subscribe"}, {"topic"}),
    "services": (set(), {"reply", "request"}, {"service"}),
    "actions": (set(), {"call", "execute"}, {"action"}),
    "topic": (set(), set(), set()),
    "service": (set(), set(), set()),
    "action": (set(), set(), set()),
}
_RULES = {"publish", "subscribe", "reply", "request", "call", "execute"}
_QUALIFIERS = {"ALLOW", "DENY"}
_MAY_BE_EMPTY = {"profile", "topic", "service", "action"}


def problems(element: ElementTree.Element) -> list[str]:
    """What the schema does not allow in an element and below."""
    required, optional, children = SCHEMA[element.tag]
    found = []
    if not required <= set(element.keys()) or not set(element.keys()) <= required | optional:
        found.append(f"{element.tag}: attributes {sorted(element.keys())}")
    found += [
        f"{element.tag}: {rule}='{element.get(rule)}'"
        for rule in _RULES & set(element.keys())
        if element.get(rule) not in _QUALIFIERS
    ]
    if not len(element) and element.tag not in _MAY_BE_EMPTY:
        found.append(f"{element.tag}: empty")
    for child in element:
        if child.tag not in children:
            found.append(f"{element.tag}: {child.tag} inside")
        else:
            found += problems(child)
    return found


def rows(heading: str) -> list[str]:
    """Names in the first column of a table of docs/interfaces.md."""
    text = (ROOT / "docs" / "interfaces.md").read_text(encoding="utf-8")
    section = text.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    return [line.split("`")[1] for line in section.splitlines() if line.startswith("| `")]


def granted(kind: str) -> dict[str, set[str]]:
    """node -> absolute names that it is granted for publish, subscribe, reply or request."""
    answer: dict[str, set[str]] = {}
    for policy in POLICIES:
        for profile in ElementTree.parse(policy).iter("profile"):
            node = str(profile.get("node"))
            names = answer.setdefault(node, set())
            for group in profile:
                if group.get(kind) == "ALLOW":
                    for entry in group:
                        text = str(entry.text).replace("~", f"/{node}")
                        names.add("/" + text.lstrip("/"))
    return answer


def who(kind: str, name: str) -> set[str]:
    """Nodes that are granted a name."""
    return {node for node, names in granted(kind).items() if any(fnmatch(name, n) for n in names)}


@pytest.mark.parametrize("policy", POLICIES, ids=lambda path: path.stem)
def test_a_policy_keeps_the_schema(policy: Path) -> None:
    root = ElementTree.parse(policy).getroot()
    assert (root.tag, root.get("version")) == ("policy", "0.2.0")
    assert problems(root) == []
    assert [each.get("path") for each in root.iter("enclave")] == [f"/ghc/{policy.stem}"]


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ('="ALLOW"', '="PERMIT"'),
        ('ns="/" ', ""),
        ("topics", "enclaves"),
        ('path="/ghc/controller"', 'name="/ghc/controller"'),
    ],
)
def test_a_mistake_is_found(good: str, bad: str) -> None:
    text = POLICIES[0].read_text(encoding="utf-8")
    assert good in text
    assert problems(ElementTree.fromstring(text.replace(good, bad)))


def test_every_topic_has_a_publisher_and_a_reader_with_a_name() -> None:
    for row in rows("Topics"):
        name = "/" + row.lstrip("/").replace("<name>", "left_hand").replace("<task>", "elbow")
        assert who("publish", name), name
        assert who("subscribe", name), name


def test_states_and_torques_have_one_source_each() -> None:
    assert who("publish", "/joint_states") == {"sim_bridge"}
    assert who("publish", "/joint_commands") == {"controller"}
    assert who("publish", "/effort_controller/commands") == {"controller"}
    for names in (granted("publish")["recorder"], granted("publish")["viewer"]):
        assert names <= {"/diagnostics", "/rosout", "/parameter_events"}


def test_every_generator_may_plan_from_its_input() -> None:
    """Its node has the generator's name."""
    for name in GENERATORS.built_in:
        assert "/constraints/preview" in granted("publish")[name]
        assert {"/ghc/tick", f"/{GENERATORS[name].input.topic}"} <= granted("subscribe")[name]
        assert f"/{name}/get_parameters" in granted("reply")[name]


def test_services_are_served_by_their_node_and_called_by_the_operator() -> None:
    for row in rows("Services"):
        name = "/" + row
        assert who("reply", name) == {name.split("/")[1]}
        callers = who("request", name)
        assert callers == ({"console"} if name.startswith("/controller") else set())


def test_the_script_says_what_it_needs(tmp_path: Path) -> None:
    script = ROOT / "security" / "make_keystore.sh"
    assert os.access(script, os.X_OK)
    assert subprocess.run(["bash", "-n", str(script)], check=False).returncode == 0
    run = subprocess.run(
        ["bash", str(script), str(tmp_path / "keys")],
        env={"PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (run.returncode, "source a ROS 2 installation" in run.stderr) == (2, True)
