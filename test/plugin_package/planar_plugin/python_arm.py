"""The same arm as a robot written in Python."""

from __future__ import annotations

from pathlib import Path

import ghc_controller as ghc


def arm() -> ghc.Robot:
    """The arm, with a task of the kind that this package brings."""
    return ghc.Robot.from_urdf(
        Path(__file__).parent / "arm" / "planar_arm.urdf",
        tasks=[
            ghc.TaskEntry("joint_sum", "fold", 100.0, 20.0, {"reference": 1.2}),
            ghc.posture("posture", stiffness=100.0, damping=20.0),
        ],
        hierarchy="fold",
        name="planar_python_arm",
    )
