"""Base class and registry of generators, which turn raw input into previews at each tick.

A new generator is one file with a subclass of `Generator`, registered by its name:

    @register_generator("my_limits")
    class MyLimits(Generator):
        kind = TORQUE_LIMITS                        # constraint that follows its previews
        settings_type = MySettings                  # declared: step, horizon, smoothing, ...
        input = Sensor("constraints/my_input", "my_msgs/MyInput", read)

Other packages register it as an entry point of the group "ghc_mpc_constraints.generators". The
node `generator` runs it by name; its settings are parameters of that node.
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
    """Input sent in advance: latched schedules with a start time."""

    topic: str
    message: str  # type, as "ghc_msgs/ContactSchedule"
    # (message, time [s] at which its times are zero, known names) -> schedules; raises GhcError
    read: Callable[[Any, float, Sequence[str]], tuple[LimitSchedule, ...]]
    names: str = "joints"  # parameter with the names that exist


@dataclass(frozen=True, slots=True)
class Sensor:
    """Measured input: a stream of stamped messages, of which the newest is used."""

    topic: str
    message: str  # type, as "ghc_msgs/ObstacleStateArray"
    # (message, callback to reject parts of it) -> argument of `observe`; raises GhcError
    read: Callable[[Any, Callable[[str], None]], Any]


class Generator(ABC):
    """Plans the bounds of the rows of one constraint over a receding horizon.

    Independent of ROS and clocks: times are arguments, in [s] of the robot's time.

    Attributes:
        counts: event counts by name; those in `TROUBLE` are warnings.
        horizon: the grid of its previews.
    """

    kind: ClassVar[str]  # kind of its previews, such as "contact_forces"
    settings_type: ClassVar[type]  # declared dataclass with step, horizon and smoothing
    input: ClassVar[Schedules | Sensor]
    TROUBLE: ClassVar[tuple[str, ...]] = ("held", "tightened")

    horizon: Horizon
    settings: Any
    counts: Counter[str]

    @abstractmethod
    def __init__(self, settings: Any) -> None:
        """Store settings of `settings_type`.

        Raises:
            InvalidValue: inconsistent settings.
        """

    @abstractmethod
    def observe(self, given: Any, now: float) -> None:
        """Process an input at `now` [s]: a schedule, or the value returned by `Sensor.read`."""

    @abstractmethod
    def tick(self, time: float) -> Preview:
        """Plan from `time` [s]; called again for the same time, the start is the same."""

    @abstractmethod
    def take_over(self, in_force: Preview) -> None:
        """Start from current bounds or motions, given as the first point of a preview.

        Has no effect on rows that this generator has already planned.
        """

    @abstractmethod
    def reset(self) -> None:
        """Discard inputs and previews: time restarts."""

    def previews(self, time: float) -> tuple[Preview, ...]:
        """All previews from `time` [s]; several if the generator plans for several kinds."""
        return (self.tick(time),)

    @property
    def second_opinions(self) -> int:
        """How often another solver had to repeat the structured solve."""
        return 0


GENERATORS: Registry[type[Generator]] = Registry(
    "generator",
    "ghc_mpc_constraints.generators",
    modules="ghc_mpc_constraints.generators",
    base=Generator,
)
register_generator = GENERATORS.register
