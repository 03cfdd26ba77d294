"""The same arm as robots written in Python."""

from __future__ import annotations

from pathlib import Path

import ghc_controller as ghc

_URDF = Path(__file__).parent / "arm" / "planar_arm.urdf"


def arm() -> ghc.Robot:
    """The arm, with a task of the kind that this package brings."""
    return ghc.Robot.from_urdf(
        _URDF,
        tasks=[
            ghc.TaskEntry("joint_sum", "fold", 100.0, 20.0, {"reference": 1.2}),
            ghc.posture("posture", stiffness=100.0, damping=20.0),
        ],
        hierarchy="fold",
        name="planar_python_arm",
    )


def guarded_arm() -> ghc.Robot:
    """The arm with its hand on a wheel, and a bound before the reference of its task."""
    return ghc.Robot.from_urdf(
        _URDF,
        tasks=[
            ghc.TaskEntry("joint_sum", "fold", 100.0, 20.0, {"reference": 1.2}),
            ghc.posture("posture", stiffness=100.0, damping=20.0),
        ],
        hierarchy="fold",
        name="planar_guarded_arm",
        contacts=[
            {
                "name": "wheel",
                "kind": "wheel",
                "frame": "hand",
                "points": [[0.0, 0.0, 0.0]],
                "normal": [0.0, 0.0, 1.0],
                "active": True,
            }
        ],
        constraints=[{"name": "guard", "kind": "fold_guard", "lower": 1.3}],
    )
