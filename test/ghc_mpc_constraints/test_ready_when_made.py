"""A generator that is made has all its compiled code: no tick is late because of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import benchmarks

# In a process of its own, where no other test has called anything before.
_SCRIPT = """
import sys
from numba.core.dispatcher import Dispatcher
from benchmarks.previews.mpc_loads import CHANGE_EVERY, LOADS, STEP

def specialised():
    return {
        f"{name}.{key}": len(value.signatures)
        for name, module in sys.modules.items() if name.startswith("ghc_")
        for key, value in vars(module).items() if isinstance(value, Dispatcher)
    }

load = next(kind for kind in LOADS if kind.generator == sys.argv[1])(2, 0.5)
before = specialised()
assert any(before.values()), "nothing is compiled at all"
for number in range(4 * CHANGE_EVERY):
    if number % CHANGE_EVERY == 0:
        load.change(number * STEP)
    load.tick(number * STEP)
after = specialised()
print([name for name, count in after.items() if count > before[name]])
"""


@pytest.mark.parametrize("generator", ["contact_force_bounds", "obstacle_bounds"])
def test_no_tick_compiles(generator: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _SCRIPT, generator],
        capture_output=True,
        text=True,
        check=False,
        cwd=Path(benchmarks.__file__).parents[1],
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[]"
