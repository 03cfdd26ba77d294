"""The page with sliders beside a running controller: a target, a hierarchy and a gain."""

from __future__ import annotations

import http.client
import json
import re
import time
from collections.abc import Callable
from typing import Any

import pytest

from ghc_controller.robot.library import load_robot

pytestmark = [pytest.mark.long, pytest.mark.timeout(400)]

DEADLINE = 120.0  # [s] wall
SHIFT = 0.05  # [m]


class Page:
    """Requests as the page makes them."""

    def __init__(self, address: str) -> None:
        found = re.search(r"127\.0\.0\.1:(\d+)/#(\S+)", address)
        assert found, address
        self._port, self._token = int(found[1]), found[2]

    def act(self, action: str, /, **fields: Any) -> tuple[int, Any]:
        """Status and content of the answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self._port, timeout=30.0)
        connection.request("POST", f"/{action}", json.dumps(fields), {"X-Token": self._token})
        answer = connection.getresponse()
        content = json.loads(answer.read())
        connection.close()
        return answer.status, content

    def until_gains(self, condition: Callable[[Any], bool]) -> Any:
        """Wait until the gains fulfill a condition; the gains."""
        return self.until(lambda now: condition(now["gains"]), lambda: None, gains=True)["gains"]

    def until(
        self, condition: Callable[[Any], bool], again: Callable[[], object], **fields: Any
    ) -> Any:
        """Repeat `again` until the state fulfills a condition; the state."""
        deadline = time.monotonic() + DEADLINE
        while True:
            again()
            status, state = self.act("state", **fields)
            if status == 200 and condition(state):
                return state
            assert time.monotonic() < deadline, state
            time.sleep(0.05)


def test_sliders_move_the_robot(start_node: Callable[..., Any]) -> None:
    robot = ("--ros-args", "-p", "robot:=kuka_lwr")
    mode = ("-p", "mode:=realtime")
    start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", "-p", "scene:=kuka_lwr", *mode)
    start_node("ghc_controller", "controller", *robot)
    start_node("ghc_controller", "reachable_targets", *robot)
    node = start_node("ghc_controller", "steer", *robot)
    node.wait_for_output("open http://")
    page = Page(node.output)
    state = page.until(lambda _: True, lambda: None)
    (target,) = [task for task in state["targets"] if task["name"] == "end_effector"]
    goal = [target["position"][0], target["position"][1] + SHIFT, target["position"][2]]

    def is_there(now: Any) -> bool:
        (moved,) = [task for task in now["targets"] if task["name"] == "end_effector"]
        return abs(moved["position"][1] - goal[1]) < 1e-3

    # Sliders of gains start at those of the controller.
    tuned = page.until_gains(lambda gains: len(gains) == 6)
    assert tuned["tasks.elbow.stiffness"] == load_robot("kuka_lwr").tasks[1].stiffness[0]
    page.until(is_there, lambda: page.act("target", task="end_effector", position=goal))
    assert page.act("hierarchy", hierarchy="elbow > posture", duration=0.2)[0] == 200
    page.until(lambda now: now["hierarchy"] == "elbow > posture", lambda: None)
    status, answer = page.act("gain", name="tasks.elbow.stiffness", value=60.0)
    assert (status, answer["text"]) == (200, "SET tasks.elbow.stiffness 60")
    page.until_gains(lambda gains: gains["tasks.elbow.stiffness"] == 60.0)
    status, answer = page.act("gain", name="tasks.elbow.stiffness", value=-1.0)
    assert status == 400
    assert "out of range" in answer["error"]
    assert node.stop() == 0, node.output
