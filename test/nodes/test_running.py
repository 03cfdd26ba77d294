"""Every line of docs/running.md, as whole systems over DDS, in lockstep."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from display_client import Display

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "running.md"
DISPLAY = ROOT / "docs" / "display.md"
WAIT = 120.0  # [s] wall
REQUESTS = ("reference", "transition")
_BLOCK = re.compile(r"^```bash\n(.*?)^```$", re.DOTALL | re.MULTILINE)


class Line(NamedTuple):
    """One `ros2 run` of the page."""

    package: str
    executable: str
    arguments: list[str]


def lines_of(text: str) -> list[Line]:
    found = []
    for line in "".join(_BLOCK.findall(text)).splitlines():
        ros2, run, package, executable, *arguments = shlex.split(line)
        assert (ros2, run) == ("ros2", "run"), line
        found.append(Line(package, executable, arguments))
    return found


def sections(page: Path) -> dict[str, list[Line]]:
    """Heading -> its lines; headings without any are left out."""
    parts = page.read_text(encoding="utf-8").split("\n## ")[1:]
    found = {part.splitlines()[0]: lines_of(part) for part in parts}
    return {heading: lines for heading, lines in found.items() if lines}


@pytest.fixture
def display(ros_context: Any) -> Iterator[Display]:
    made = Display(ros_context)
    yield made
    made.close()


def start(start_node: Callable[..., Any], line: Line) -> Any:
    arguments = [text.replace("mode:=realtime", "mode:=lockstep") for text in line.arguments]
    if line.executable == "sim_bridge":
        arguments += ["-p", f"lockstep_timeout:={WAIT}"]
    return start_node(line.package, line.executable, *arguments)


@pytest.mark.timeout(600)
@pytest.mark.parametrize("system", sections(PAGE))
def test_a_system_of_the_page_runs_and_is_drawn(
    start_node: Callable[..., Any], display: Display, system: str
) -> None:
    lines = sections(PAGE)[system]
    nodes = [start(start_node, line) for line in lines if line.executable not in REQUESTS]
    moving = "left/tool" if system.startswith("Two") else ("l_sole", "tool")
    display.until(
        lambda: any(
            name in display.transforms
            for name in ([moving] if isinstance(moving, str) else moving)
        )
    )
    for line in lines:
        if line.executable in REQUESTS:
            run = start(start_node, line)
            assert run.wait(WAIT) == 0, run.output
            assert run.output.splitlines()[-1].split()[4] in ("REACHED", "DONE")
    if not system.startswith("Two"):
        display.until(lambda: display.marks("targets"))
    if "obstacle" in system:
        display.until(lambda: display.marks("virtual obstacles"))
    if "humanoid" in system:
        display.until(lambda: len(display.marks("forces")) == 2)
    assert [node.exit_code for node in nodes] == [None] * len(nodes)
    for node in nodes:
        assert "Traceback" not in node.output


def test_the_page_has_the_systems_that_users_ask_for() -> None:
    found = sections(PAGE)
    assert [len(lines) for lines in found.values()] == [5, 5, 5, 4]
    assert [line.executable for line in lines_of(DISPLAY.read_text(encoding="utf-8"))] == [
        "display_publisher"
    ]
