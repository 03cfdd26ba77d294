"""What a generator is: raw input in, previews of a constraint out, tick by tick. And their names.

A new generator is one file with a subclass of `Generator`, registered by its name:

    @register_generator("my_limits")
    class MyLimits(Generator):
        kind = TORQUE_LIMITS                        # which constraint follows its previews
        settings_type = MySettings                  # declared: step, horizon, smoothing, ...
        input = Sensor("constraints/my_input", "my_msgs/MyInput", read)

Another package lists it as an entry point of the group "ghc_mpc_constraints.generators". The node
`generator` runs it by its name; its settings are parameters of that node.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from ghc_controller.previews.preview import Preview
from ghc_controller.registry import Registry
from ghc_mpc_constraints.previews.horizon import Horizon
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule


@dataclass(frozen=True, slots=True)
class Schedules:
    """Input that is sent ahead: latched schedules, each known from a time on."""

    topic: str
    message: str  # type, as "ghc_msgs/ContactSchedule"
    # (message, time [s] from which its times count, known names) -> schedules; raises GhcError
    read: Callable[[Any, float, Sequence[str]], tuple[LimitSchedule, ...]]
    names: str = "joints"  # parameter with the names that exist


@dataclass(frozen=True, slots=True)
class Sensor:
    """Input that is measured: a stream of messages with a header, the newest one counts."""

    topic: str
    message: str  # type, as "ghc_msgs/ObstacleStateArray"
    # (message, rejects a part of it with a reason) -> what `observe` takes; raises GhcError
    read: Callable[[Any, Callable[[str], None]], Any]


class Generator(ABC):
    """Plans the bounds of the rows of one constraint over a receding horizon.

    No ROS and no clock of its own: times are those of the robot [s]. A generator compiles what it
    needs when it is made.

    Attributes:
        counts: how often what happened, by name; those of `TROUBLE` are warnings.
        horizon: the grid of its previews.
    """

    kind: ClassVar[str]  # of its previews, such as "contact_forces"
    settings_type: ClassVar[type]  # declared dataclass with step, horizon and smoothing
    input: ClassVar[Schedules | Sensor]
    TROUBLE: ClassVar[tuple[str, ...]] = ("held", "tightened")

    horizon: Horizon
    settings: Any
    counts: Counter[str]

    @abstractmethod
    def __init__(self, settings: Any) -> None:
        """Take settings of `settings_type`, and compile.

        Raises:
            InvalidValue: settings that cannot be used together.
        """

    @abstractmethod
    def observe(self, given: Any, now: float) -> None:
        """Take an input: a schedule, or what the `read` of its sensor returned, at `now` [s]."""

    @abstractmethod
    def tick(self, time: float) -> Preview:
        """Plan from `time` [s]; called again for the same time, the start is the same."""

    @abstractmethod
    def take_over(self, in_force: Preview) -> None:
        """Start from the bounds or motions in force, the first point of a preview.

        Has no effect on rows that this generator has planned already.
        """

    @abstractmethod
    def reset(self) -> None:
        """Forget inputs and previews: time starts again."""

    def previews(self, time: float) -> tuple[Preview, ...]:
        """All that is planned from `time` [s]; more than one for a generator of several kinds."""
        return (self.tick(time),)

    @property
    def second_opinions(self) -> int:
        """How often the structured solve had to be repeated by another solver."""
        return 0


GENERATORS: Registry[type[Generator]] = Registry(
    "generator",
    "ghc_mpc_constraints.generators",
    modules="ghc_mpc_constraints.generators",
    base=Generator,
)
register_generator = GENERATORS.register
