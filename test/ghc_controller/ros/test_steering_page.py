"""The page with sliders: who may use it, and what a real browser does with it."""

from __future__ import annotations

import http.client
import json
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from browser import CHROMIUM, Browser
from ghc_msgs.msg import ControllerState, TaskState

from ghc_controller.errors import InvalidValue
from ghc_controller.robot.library import load_robot
from ghc_controller.ros.steering.node import orientation_kept
from ghc_controller.ros.steering.page_server import PageServer
from ghc_controller.tasks.frame import FramePoseTask

START = [0.4, 0.0, 0.8]


@pytest.fixture
def sent() -> list[tuple[str, Mapping[str, Any]]]:
    """Actions with their fields, in order."""
    return []


@pytest.fixture
def page(sent: list[tuple[str, Mapping[str, Any]]]) -> Iterator[PageServer]:
    """A page whose actions are kept."""

    def action(name: str, fields: Mapping[str, Any]) -> Any:
        sent.append((name, fields))
        if fields.get("hierarchy") == "hnad":
            raise InvalidValue("unknown task 'hnad'")
        return {"text": "done"}

    state = {
        "time": 1.0,
        "hierarchy": "hand > posture",
        "tasks": [{"name": "hand", "error": 1e-3}],
        "targets": [{"name": "hand", "position": START}],
        "gains": {"tasks.hand.stiffness": 30.0},
        "news": [],
    }
    actions: dict[str, Any] = {
        name: lambda fields, name=name: action(name, fields)
        for name in ("target", "hierarchy", "gain")
    }
    server = PageServer({"state": lambda _: state, **actions})
    yield server
    server.close()


def _request(
    page: PageServer, method: str, path: str, headers: Mapping[str, str], body: str = "{}"
) -> tuple[int, str]:
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=60.0)
    try:
        connection.request(method, path, body if method == "POST" else None, dict(headers))
        answer = connection.getresponse()
        return answer.status, answer.read().decode()
    finally:
        connection.close()


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"X-Token": "guessed"},
        {"X-Token": "TOKEN", "Origin": "http://evil.example"},
        {"X-Token": "TOKEN", "Origin": "null"},
        {"X-Token": "TOKEN", "Host": "evil.example"},
    ],
)
def test_other_pages_get_nothing(
    page: PageServer, sent: list[Any], headers: dict[str, str]
) -> None:
    given = {name: value.replace("TOKEN", page.token) for name, value in headers.items()}
    status, _ = _request(page, "POST", "/target", given)
    assert status == 403
    assert sent == []


def test_its_own_page_acts_and_reads_reasons(page: PageServer, sent: list[Any]) -> None:
    own = {"X-Token": page.token, "Origin": f"http://127.0.0.1:{page.port}"}
    assert _request(page, "POST", "/gain", own, '{"name": "a", "value": 2}')[0] == 200
    assert sent == [("gain", {"name": "a", "value": 2})]
    status, text = _request(page, "POST", "/hierarchy", own, '{"hierarchy": "hnad"}')
    assert (status, json.loads(text)["error"]) == (400, "unknown task 'hnad'")
    for body in ("[]", "nonsense", '"' + "x" * 20000 + '"'):
        assert _request(page, "POST", "/gain", own, body)[0] == 400
    assert _request(page, "POST", "/no_such", own)[0] == 404
    status, text = _request(page, "GET", "/", {})
    assert status == 200
    assert page.token not in text


@pytest.mark.long
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_a_browser_moves_a_target_a_gain_and_the_hierarchy(
    page: PageServer, sent: list[tuple[str, Mapping[str, Any]]], tmp_path: Path
) -> None:
    with Browser(page.address, tmp_path) as browser:
        browser.until("!!document.getElementById('hand.y')")
        browser.move("hand.y", 0.125, "input")
        browser.move("tasks.hand.stiffness", 45, "change")
        for hierarchy in ("posture > hand", "hnad"):
            browser.value(
                f"document.getElementById('hierarchy').value = '{hierarchy}';"
                "document.getElementById('change').click()"
            )
        browser.until("document.getElementById('log').innerText.includes('hnad')")
        deadline = time.monotonic() + 60.0
        while len(sent) < 4 and time.monotonic() < deadline:
            time.sleep(0.05)
        shown = browser.value("document.body.innerText")
    assert "t = 1.00 s, hand > posture" in shown
    assert "unknown task 'hnad'" in shown
    targets = [fields for name, fields in sent if name == "target"]
    assert targets[-1] == {"task": "hand", "position": [START[0], 0.125, START[2]]}
    assert ("gain", {"name": "tasks.hand.stiffness", "value": 45}) in sent
    assert ("hierarchy", {"hierarchy": "posture > hand", "duration": 2}) in sent


@pytest.mark.long
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_a_slider_leaves_the_other_axes_where_the_target_is_by_now(
    page: PageServer, sent: list[tuple[str, Mapping[str, Any]]], tmp_path: Path
) -> None:
    """Not where it was when the page was opened: others have moved the robot since."""
    with Browser(page.address, tmp_path) as browser:
        browser.until("!!document.getElementById('hand.y')")
        page.actions["state"]({})["targets"][0]["position"] = [0.5, 0.1, 0.7]
        browser.until("document.getElementById('hand.z').value == 0.7")
        browser.move("hand.y", 0.125, "input")
        deadline = time.monotonic() + 10.0
        while not sent and time.monotonic() < deadline:
            time.sleep(0.05)
    assert sent[-1] == ("target", {"task": "hand", "position": [0.5, 0.125, 0.7]})


def test_a_position_alone_does_not_turn_a_pose() -> None:
    """The orientation is that of the controller's report; without one nothing is sent."""
    model = load_robot("kuka_lwr").model
    pose = FramePoseTask("hand", model, "tool", 30.0, 20.0)
    turned = [0.6, 0.0, 0.0, 0.8]
    state = TaskState(name="hand", reference=[*START, *turned])
    assert orientation_kept(pose, ControllerState(tasks=[state])) == turned
    for report in (None, ControllerState(tasks=[TaskState(name="elbow")])):
        with pytest.raises(InvalidValue, match="orientation"):
            orientation_kept(pose, report)
