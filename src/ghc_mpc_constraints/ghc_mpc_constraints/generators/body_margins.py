"""Generator of margins between bodies: a margin that is raised, or an obstacle that appears.

A margin that steps above the present distance would push both bodies apart with a jump. Instead
it moves as a chain of three integrators with a weight on its jerk, as a joint limit does (thesis,
eq. 4.11 to 4.16), so that the distance follows with a continuous acceleration. A rise that was
announced is complete when it takes effect. One that was not is taken for an obstacle that
approaches: it is due after the reaction time of eq. 4.4, each one of several after its own. The
first schedule of a margin starts from that of robot.yaml.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ghc_controller.constraints.rows.body_distance import BodyDistance
from ghc_controller.previews.preview import BODY_MARGINS
from ghc_controller.robot.library import load_robot
from ghc_controller.schema.declared import declared, inline
from ghc_controller.schema.domains import POSITIVE
from ghc_mpc_constraints.generator import Schedules, register_generator
from ghc_mpc_constraints.generators.joint_limits import JointLimits, JointLimitSettings
from ghc_mpc_constraints.obstacle_motion.approach import ReactionTime
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule

_SAME = 1e-6  # [m] a rise below it is none
_NO_UPPER = 1e3  # [m] upper bound, which says nothing


class MarginSchedule(LimitSchedule):
    """Margins over time; the upper bounds say nothing."""

    THING = "margin"


@dataclass(frozen=True, slots=True)
class BodyMarginSettings(JointLimitSettings):
    """Settings of the generator: those of joint limits, and the reaction time of a sudden rise.

    Raises:
        InvalidValue: a number outside its range.
    """

    tighten_rate: float = declared(
        "towards the largest margin ahead, without solution and preview",
        0.1,
        unit="m/s",
        domain=POSITIVE,
    )
    reaction: ReactionTime = inline(ReactionTime)
    robot: str = declared(
        "name, or path of its robot.yaml, whose margins are in force before the first schedule; "
        "without it, those of a first schedule are in force at once",
        "",
    )


@register_generator("body_margins")
class BodyMargins(JointLimits):
    """Every scheduled margin over a receding horizon; rows are names of margins."""

    kind = BODY_MARGINS
    settings_type = BodyMarginSettings
    input = Schedules(
        "constraints/body_margin_schedule",
        "ghc_msgs/LimitSchedule",
        MarginSchedule.read,
        "margins",
    )

    def __init__(self, settings: BodyMarginSettings) -> None:
        """Compute the constant matrices; read the margins of the robot.

        Raises:
            InvalidValue: the horizon is not a multiple of the step.
            UnknownName, ConfigurationError: the robot cannot be read.
        """
        super().__init__(settings)
        self._of_file = margins_of(settings.robot) if settings.robot else {}

    def observe(self, given: LimitSchedule, now: float) -> None:
        """Use a schedule; rises that come too soon are due after their reaction times."""
        file = self._of_file.get(given.name)
        if file is not None:  # the controller keeps it whatever is given
            given = replace(given, lower=np.maximum(given.lower, file))
            if given.name not in self._schedules and given.name not in self._handed_over:
                self.start_from(given.name, file, _NO_UPPER)
        self.hold_handed_over()  # else the first entry would apply to earlier times too
        super().observe(self._with_reaction(given, now), now)

    def _with_reaction(self, given: LimitSchedule, now: float) -> LimitSchedule:
        in_force = self._in_force(given.name, now)
        if in_force is None or not self.settings.smoothing:
            return given
        times: list[float] = []
        kept: list[int] = []
        for entry, (time, rise) in enumerate(
            zip(given.times.tolist(), (given.lower - in_force[0]).tolist(), strict=True)
        ):
            due = max(time, now + self.settings.reaction.of(rise)) if rise > _SAME else time
            while times and times[-1] >= due:  # this entry is in force before that one is due
                times.pop()
                kept.pop()
            times.append(due)
            kept.append(entry)
        return replace(
            given, times=np.array(times), lower=given.lower[kept], upper=given.upper[kept]
        )


def margins_of(robot: str) -> dict[str, float]:
    """Name -> margin [m] of a robot.yaml.

    Raises:
        UnknownName, ConfigurationError: see `load_robot`.
    """
    found = (one for one in load_robot(robot).constraints if isinstance(one, BodyDistance))
    return {name: margin for one in found for name, margin in one.least_margins.items()}
