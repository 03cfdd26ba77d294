"""Running nodes take mutated bytes on every topic: none ends, the robot goes on."""

from __future__ import annotations

from pathlib import Path

from benchmarks.fuzz.node_fuzz import fuzz_nodes


def test_mutated_messages_end_nothing(ros_domain_id: int, tmp_path: Path) -> None:
    outcome = fuzz_nodes(600, seed=3, folder=tmp_path)
    assert outcome["holds"], outcome
    assert outcome["cases"] == 600
    assert outcome["rejected"] > 100
