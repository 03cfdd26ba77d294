"""The part of docs/reliability.md about the whole stack over a long time."""

# ruff: noqa: E501 - lines of a page

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from benchmarks.soak.memory import GROWTH_GOAL
from benchmarks.soak.section import STACK

_HEAD = """## The stack over a long time

`make soak ARGS="--stack --write-docs"`: bridge in lockstep at 200 Hz, controller, both generators and the recorder with every message, {simulated:.0f} s of simulated time ({wall:.0f} s of the wall's) under random requests, references, schedules and obstacles twice a second, {kills} kills in motion. {recorded}

Growth is the slope of a line through the resident memory after the first {warm_up:.0f} s of a process; goal: {goal:g} MB per hour. A life of less than {least:.0f} s after that says nothing.

| node | lives | longest life [s] | memory at its end [MB] | largest growth [MB/h] | |
|---|---|---|---|---|---|
"""


def write_stack_section(figures: Mapping[str, Any], document: Path, least: float = 60.0) -> None:
    """Put the figures of a run into the document."""
    missing, ticks = figures["ticks_missing"], figures["ticks"]
    recorded = (
        f"All {ticks} states are in the recording."
        if not missing
        else f"**{missing} of {ticks} states are not in the recording.**"
    )
    text = _HEAD.format(
        simulated=figures["simulated_s"],
        wall=figures["wall_s"],
        kills=figures["kills"],
        recorded=recorded,
        warm_up=figures["warm_up_s"],
        goal=GROWTH_GOAL,
        least=least,
    )
    lives = figures["lives"]
    for node in dict.fromkeys(life["node"] for life in lives):
        own = [life for life in lives if life["node"] == node]
        longest = max(own, key=lambda life: float(life["lived_s"]))
        slopes = [life["growth_mb_per_hour"] for life in own]
        known = [slope for slope in slopes if slope is not None]
        cells = [
            f"`{node}`",
            f"{len(own)}",
            f"{longest['lived_s']:.0f}",
            f"{longest['last_mb']:.1f}",
            f"{max(known):.2f}" if known else "",
            ("met" if max(known) <= GROWTH_GOAL else "missed") if known else "too short",
        ]
        text += "| " + " | ".join(cells) + " |\n"
    before = document.read_text(encoding="utf-8")
    document.write_text(STACK.put(before, text), encoding="utf-8")
