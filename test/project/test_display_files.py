"""The layout for Foxglove and the configuration for RViz name topics and fields that exist."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import yaml
from doc_text import ROOT
from ghc_msgs import msg

FOXGLOVE = ROOT / "docs" / "display" / "foxglove.json"
RVIZ = ROOT / "docs" / "display" / "robot.rviz"
TOPICS = dict(
    re.findall(
        r"^\| `([^`]+)` \| `(\w+/msg/\w+)` \|",
        (ROOT / "docs" / "interfaces.md").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
)


def _panels(layout: Any) -> Iterator[str]:
    """Panels of a tree of splits."""
    if isinstance(layout, str):
        yield layout
        return
    for side in ("first", "second"):
        yield from _panels(layout[side])


def test_every_panel_of_the_layout_is_configured_and_shown_once() -> None:
    layout = json.loads(FOXGLOVE.read_text(encoding="utf-8"))
    shown = list(_panels(layout["layout"]))
    assert sorted(shown) == sorted(layout["configById"])
    assert {panel.partition("!")[0] for panel in shown} == {
        "3D", "Plot", "RawMessages", "DiagnosticSummary",
    }  # fmt: skip


def test_plots_of_the_layout_are_of_fields_that_exist() -> None:
    panels = json.loads(FOXGLOVE.read_text(encoding="utf-8"))["configById"]
    assert panels["3D!robot"]["followTf"] == "world"
    for topic in panels["3D!robot"]["topics"]:
        assert topic.lstrip("/") in TOPICS
    paths = [path["value"] for panel in panels.values() for path in panel.get("paths", ())]
    assert len(paths) > 10
    for path in paths:
        topic, *fields = path.split(".")
        kind = TOPICS[topic.removeprefix("/")]
        for field in fields:
            name = re.sub(r"\[\d+\]$", "", field)
            types = getattr(msg, kind.rpartition("/")[2]).get_fields_and_field_types()
            assert name in types, path
            assert ("sequence" in types[name]) == field.endswith("]"), path
            kind = types[name].removeprefix("sequence<").rstrip(">")
    assert TOPICS[panels["RawMessages!mode"]["topicPath"].removeprefix("/")]


def test_displays_of_rviz_read_what_is_published() -> None:
    manager = yaml.safe_load(RVIZ.read_text(encoding="utf-8"))["Visualization Manager"]
    assert manager["Global Options"]["Fixed Frame"] == "world"
    displays = {entry["Class"].rpartition("/")[2]: entry for entry in manager["Displays"]}
    described = displays["RobotModel"]["Description Topic"]
    assert TOPICS[described["Value"]] == "std_msgs/msg/String"
    assert described["Durability Policy"] == "Transient Local"
    marked = displays["MarkerArray"]["Topic"]
    assert TOPICS[marked["Value"]] == "visualization_msgs/msg/MarkerArray"
    assert marked["Reliability Policy"] == "Reliable"
