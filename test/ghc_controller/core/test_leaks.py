"""Nothing of the core outlives the interpreter: nanobind warns of what does, when it ends."""

from __future__ import annotations

import subprocess
import sys

import pytest

PROGRAM = """
import numpy as np
import ghc_controller as ghc

def stepped():
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"))
    state = ghc.RobotState(0.0, np.full(7, 0.3), np.zeros(7))
    controller.observe(state)
    controller.step(state)
    controller.problem()
    return controller

"""


@pytest.mark.parametrize(
    "end", ["stepped()", "kept = stepped()", "import gc; gc.disable(); stepped()"]
)
def test_a_controller_that_lives_until_the_end_leaves_nothing(end: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM + end], capture_output=True, text=True, timeout=250
    )
    assert done.returncode == 0, done.stderr
    assert "leaked" not in done.stderr
