"""The lock files: pinned by hash, and consistent with each other."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    "name",
    [
        *("lock-py3.11", "lock-py3.12", "lock-noros-py3.12", "uv"),
        *("study-models-py3.11", "cluster-py3.11", "cluster-py3.12"),
        *("docs-py3.11", "docs-py3.12"),
    ],
)
def test_every_locked_package_has_a_hash(name: str) -> None:
    text = (ROOT / "requirements" / f"{name}.txt").read_text(encoding="utf-8")
    blocks = [block for block in text.replace("\\\n", " ").splitlines() if "==" in block]
    assert len(blocks) > 0
    assert [block.split()[0] for block in blocks if "--hash=sha256:" not in block] == []
    assert "http" not in text


def test_the_lock_without_ros_is_part_of_the_full_one() -> None:
    def pins(name: str) -> set[str]:
        text = (ROOT / "requirements" / name).read_text(encoding="utf-8")
        return {line.split()[0] for line in text.splitlines() if line[:1].isalnum()}

    for version in ("3.11", "3.12"):
        own, full = pins(f"lock-noros-py{version}.txt"), pins(f"lock-py{version}.txt")
        assert own < full
        assert not any(pin.startswith("ros-") for pin in own)
