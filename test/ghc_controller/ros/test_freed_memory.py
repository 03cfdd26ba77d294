"""Memory that was freed goes back to the system, also below blocks that are still in use."""

from __future__ import annotations

import subprocess
import sys

import pytest

# Blocks of 10 kB come from the heap, not from a mapping of their own; one in 500 stays.
PROGRAM = """
import ctypes
from ghc_controller.ros.process.freed_memory import limit_arenas, return_freed_memory

def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096

print(limit_arenas())
blocks = [ctypes.create_string_buffer(b"x" * 10_000) for _ in range(5000)]
kept = blocks[499::500]
del blocks
before = resident()
print(return_freed_memory(), before - resident())
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory of glibc")
def test_freed_blocks_below_a_kept_one_are_given_back() -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True, timeout=200
    )
    limited, trimmed, given_back = done.stdout.split()
    assert (limited, trimmed) == ("True", "True")
    assert int(given_back) > 40e6, "bytes of 50 MB"
