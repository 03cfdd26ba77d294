"""The order of the pages on the site. The front page gets it as its table of contents."""

from __future__ import annotations

from typing import Any

NAVIGATION: dict[str, list[str]] = {
    "Start": [
        "first_steps",
        "running",
        "tuning",
        "display",
        "robots",
        "troubleshooting",
        "mistakes",
        "glossary",
    ],
    "Tutorials": [
        "tutorials/arm",
        "tutorials/priorities",
        "tutorials/formulations",
        "own_robot",
        "tutorials/teleoperation",
        "tutorials/force",
        "tutorials/humanoid_balance",
        "tutorials/own_task",
        "hardware",
    ],
    "Concepts": [
        "concepts/priorities",
        "concepts/formulations",
        "concepts/previews",
        "architecture",
        "guarantees",
        "limits",
        "body_distances",
    ],
    "Reference": [
        "api/controller",
        "api/bridge",
        "api/previews",
        "interfaces",
        "reachable_targets",
        "plugins",
        "migration",
        "references",
    ],
    "Results": [
        "comparison",
        "reliability",
        "results",
        "humanoid",
        "task_priority",
        "rhp_hqp",
        "gn_qn",
        "limit_previews",
        "mpc_studies",
        "study",
        "benchmarks",
        "peers",
        "campaign",
    ],
}


def contents() -> str:
    """The hidden tables of contents, in Markdown of MyST."""
    parts = []
    for caption, pages in NAVIGATION.items():
        lines = ["```{toctree}", ":hidden:", f":caption: {caption}", "", *pages, "```"]
        parts.append("\n".join(lines))
    return "\n\n" + "\n\n".join(parts) + "\n"


def _append(_app: Any, docname: str, source: list[str]) -> None:
    if docname == "index":
        source[0] += contents()


def setup(app: Any) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("source-read", _append)
    return {"parallel_read_safe": True}
