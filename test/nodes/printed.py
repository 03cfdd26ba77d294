"""What a command by hand printed."""

from __future__ import annotations


def words(output: str) -> list[str]:
    """The statuses of an output, in order: what stands after the time, single-spaced."""
    lines = [line for line in output.splitlines() if line.startswith("t = ")]
    return [" ".join(line.split(" s  ", 1)[1].split()) for line in lines]
