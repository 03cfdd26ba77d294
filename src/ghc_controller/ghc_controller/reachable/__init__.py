"""References that a robot can follow, made of target streams (docs/reachable_targets.md).

Samples of a target come at 10 to 100 Hz with jumps, jitter and loss. What goes out has no steps:
position, velocity and acceleration of tasks along a motion of the joints within their limits.
"""

from ghc_controller.reachable.joint_motion import JointLimitsOfMotion
from ghc_controller.reachable.reference import ReachableReference
from ghc_controller.reachable.settings import ReachableSettings

__all__ = ["JointLimitsOfMotion", "ReachableReference", "ReachableSettings"]
