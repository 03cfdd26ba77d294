"""The robots of the benchmark, with as many tasks as asked for.

As in the GHC paper (figure 12): a posture task of lowest priority below three-dimensional motion
tasks of different links, in strict order.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

import ghc_controller as ghc
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.tasks.frame import FrameOrientationTask, FramePositionTask
from ghc_controller.tasks.posture import PostureTask
from ghc_controller.types import Array
from tools.model_packages import install_missing
from tools.workspace.layout import Layout

_STIFFNESS, _DAMPING = 30.0, 20.0  # [1/s^2], [1/s] as in the paper
_KINDS = {"position": FramePositionTask, "orientation": FrameOrientationTask}


class BenchRobot(ABC):
    """One robot; `frames` are its motion tasks, most important first: (link, kind)."""

    name: str
    title: str
    frames: Sequence[tuple[str, str]]

    @property
    def most_tasks(self) -> int:
        """Motion tasks and posture."""
        return len(self.frames) + 1

    def product(self) -> ghc.Robot:
        """The robot of the stack, with the limits of the benchmark."""
        return ghc.load_robot(self.name)

    @abstractmethod
    def model(self) -> RobotModel:
        """A new model for every caller."""

    @abstractmethod
    def start(self, model: RobotModel) -> Array:
        """(n,) [rad] posture about which the robot moves."""

    def config(self, count: int) -> ghc.Robot:
        """The robot with `count` tasks: count - 1 motion tasks above the posture."""
        model = self.model()
        tasks: list[ghc.Task] = [
            _KINDS[kind](f"{link}_{kind}", model, link, _STIFFNESS, _DAMPING)
            for link, kind in self.frames[: count - 1]
        ]
        start = self.start(model)
        tasks.append(PostureTask("posture", model, _STIFFNESS, _DAMPING, reference=start))
        hierarchy = " > ".join(task.name for task in tasks)
        product = self.product()
        return ghc.Robot(
            path=Path(self.name),
            name=self.name,
            urdf=Path(self.name),
            floating_base=False,
            torque_rate=product.torque_rate,
            brake_acceleration=product.brake_acceleration,
            model=model,
            tasks=tuple(tasks),
            hierarchy=hierarchy,
        )


class Arm(BenchRobot):
    """The KUKA LWR 4+ of the experiments."""

    name = "kuka_lwr"
    title = "KUKA LWR, 7 DoF"
    frames = (
        ("tool", "position"),
        ("elbow", "position"),
        ("tool", "orientation"),
        ("link_6", "position"),
    )

    def model(self) -> RobotModel:
        """See BenchRobot."""
        return self.product().model

    def start(self, model: RobotModel) -> Array:
        """The folded-forward posture of robot.yaml."""
        posture = self.product().tasks[-1]
        return posture.default_target(model).position


class Humanoid(BenchRobot):
    """iCub, 32 joints of legs, torso, arms and neck, fixed at the pelvis."""

    name = "icub"
    title = "iCub, 32 DoF"
    frames = (
        ("l_hand_dh_frame", "position"),
        ("r_hand_dh_frame", "position"),
        ("l_sole", "position"),
        ("r_sole", "position"),
        ("head", "orientation"),
        ("chest", "orientation"),
    )
    _MODEL = "iCubGazeboV2_5"  # the well-conditioned one among those of the package

    def __init__(self, layout: Layout) -> None:
        install_missing("icub-models", layout)
        from icub_models import get_model_file

        text = Path(get_model_file(self._MODEL)).read_text(encoding="utf-8")
        # Without the package's resources Pinocchio would warn of each mesh that it does not need.
        self.urdf_text = re.sub(r"<(visual|collision)\b.*?</\1>", "", text, flags=re.DOTALL)

    def model(self) -> RobotModel:
        """See BenchRobot."""
        model = RobotModel(pin.buildModelFromXML(self.urdf_text))
        model.limits = self.product().model.limits  # the same joints, on a base that floats
        return model

    def start(self, model: RobotModel) -> Array:
        """The middle of every joint's range: far from limits and from straight limbs."""
        return np.asarray(0.5 * (model.position_lower + model.position_upper))
