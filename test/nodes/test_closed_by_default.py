"""Nodes that are started by hand talk to this host only, until somebody decides otherwise."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from benchmarks.hosts.namespaces import UNSHARE, namespaces_work
from ghc_controller.errors import InvalidValue
from ghc_controller.ros.this_host import PROFILE, stay_on_this_host


def reports(folder: Path, choice: str, *options: str) -> dict[str, dict[str, Any]]:
    """What a stranger behind a cable and a friend on the same host saw of nodes."""
    reason = namespaces_work()
    if reason:
        pytest.skip(f"network namespaces are not allowed here: {reason}")
    script = str(Path(__file__).with_name("two_namespaces.py"))
    path = os.pathsep.join(p or "." for p in sys.path)
    run = subprocess.run(
        [*UNSHARE, sys.executable, script, str(folder), *options],
        env=os.environ | {"PYTHONPATH": path, "GHC_NETWORK": choice},
        capture_output=True,
        text=True,
        timeout=250.0,
    )
    assert run.returncode == 0, run.stderr
    answer: dict[str, dict[str, Any]] = json.loads(run.stdout)
    return answer


def test_a_stranger_receives_nothing_and_moves_nothing(ros_domain_id: int, tmp_path: Path) -> None:
    """Not by multicast and not as a peer of either side; a process of this host sees it all."""
    seen = reports(tmp_path, "")
    assert seen["stranger"] == {
        "publishers": 0, "readers": 0, "states": 0, "epochs": [], "reset": False,
    }  # fmt: skip
    assert seen["friend"]["states"] > 100
    assert seen["friend"]["epochs"] == [0]


def test_one_variable_opens_them(ros_domain_id: int, tmp_path: Path) -> None:
    """The same stranger reads and resets: the test above would have seen it."""
    seen = reports(tmp_path, "network", "--patient")
    assert seen["stranger"]["states"] > 100
    assert seen["stranger"]["reset"]


def test_what_leads_out_of_the_host_is_taken_away() -> None:
    environment = {
        "ROS_STATIC_PEERS": "10.0.0.1",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
        "ROS_DISCOVERY_SERVER": "10.0.0.1:11811",
        "FASTRTPS_DEFAULT_PROFILES_FILE": "/open.xml",
        "ROS_DOMAIN_ID": "7",
    }
    stay_on_this_host(environment)
    assert environment == {
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "FASTRTPS_DEFAULT_PROFILES_FILE": str(PROFILE),
        "SKIP_DEFAULT_XML": "1",
        "ROS_DOMAIN_ID": "7",
    }


def test_an_open_environment_is_left_as_it_is() -> None:
    environment = {"GHC_NETWORK": "network", "ROS_STATIC_PEERS": "10.0.0.1"}
    stay_on_this_host(environment)
    assert environment == {"GHC_NETWORK": "network", "ROS_STATIC_PEERS": "10.0.0.1"}


def test_an_unknown_choice_is_rejected_by_name() -> None:
    with pytest.raises(InvalidValue, match=r"GHC_NETWORK: 'open' given, 'host' .* or 'network'"):
        stay_on_this_host({"GHC_NETWORK": "open"})


def test_the_profile_has_loopback_and_shared_memory_alone() -> None:
    space = "{http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles}"
    root = ElementTree.parse(PROFILE).getroot()
    types = [str(each.text) for each in root.iter(f"{space}type")]
    assert sorted(types) == ["SHM", "UDPv4"]
    assert [each.text for each in root.iter(f"{space}address")] == ["127.0.0.1"]
    assert [each.text for each in root.iter(f"{space}useBuiltinTransports")] == ["false"]
