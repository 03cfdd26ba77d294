"""Two controllers of ros2_control as doubles: what reaches the joints, and what is broadcast.

Each rule names the upstream file and lines that define it.

[F] ros-controls/ros2_controllers, forward_command_controller/src/forward_controllers_base.cpp,
    commit c8511bb20262616e16e305b01da2d0cdc06a7429
[E] ros-controls/ros2_controllers, effort_controllers/src/joint_group_effort_controller.cpp,
    commit 3348ea04dd249d8643359acec332c7d39a7c5882
[B] ros-controls/ros2_controllers, joint_state_broadcaster/src/joint_state_broadcaster.cpp,
    commit 1ac37e4df8348868bf9ae93e847c34c70beca641
[H] ros-controls/ros2_control, hardware_interface/include/hardware_interface/handle.hpp,
    commit 016b468ae06956a294e48001690d9bace7e98976
[M] ros-controls/ros2_control, controller_manager/src/controller_manager.cpp,
    ControllerManager::update ("Deactivating following controllers as their update resulted in an
    error")
[L] ros-controls/ros2_control, controller_manager/src/ros2_control_node.cpp,
    commit 010d95f4146e85e765744ea2a007331fec3637a2
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from sensor_msgs.msg import JointState

NAN = float("nan")


class EffortInterfaces:
    """The effort command interfaces of a robot, by joint name [Nm].

    NaN until something writes to them ([H] 65-77): zero would be a command.
    """

    def __init__(self, joints: Sequence[str]) -> None:
        self.values = dict.fromkeys(joints, NAN)

    @property
    def complete(self) -> bool:
        """Whether every joint has a finite command."""
        return all(map(math.isfinite, self.values.values()))


class JointGroupEffortController:
    """effort_controllers/JointGroupEffortController, from a message to the command interfaces."""

    def __init__(self, joints: Sequence[str], interfaces: EffortInterfaces) -> None:
        """Claim one effort interface per name of the parameter `joints`, in its order."""
        self._joints = tuple(joints)
        self._interfaces = interfaces.values
        self._buffer: tuple[float, ...] | None = None
        self.active = False
        self.dropped = 0  # messages with a number that is not finite
        self.wrong_size = 0  # updates that ended in an error

    def activate(self) -> bool:
        """Every interface has to exist ([F] 106-115); what came before is forgotten ([F] 118)."""
        if not set(self._joints) <= self._interfaces.keys():
            return False
        self._buffer, self.active = None, True
        return True

    def deactivate(self) -> None:
        """Forget the command ([F] 128), and command zero to all joints ([E] 61-65)."""
        self._buffer, self.active = None, False
        for joint in self._joints:
            self._interfaces[joint] = 0.0

    def on_command(self, data: Sequence[float]) -> None:
        """A message on ~/commands. No stamp and no names: the type has none.

        One number that is not finite drops the message ([F] 65-73); any size is kept ([F] 74).
        """
        if all(map(math.isfinite, data)):
            self._buffer = tuple(data)
        else:
            self.dropped += 1

    def update(self) -> None:
        """One cycle of the controller manager.

        Without a command yet the interfaces stay as they are ([F] 137-141). A wrong size writes
        nothing and is an error ([F] 143-150), for which the manager deactivates the controller
        ([M]). Else entry i goes to joint i of the parameter ([F] 152-163), in every cycle anew:
        the last command is held indefinitely, whoever sent it, and nothing tells how old it is.
        """
        if not self.active or self._buffer is None:
            return
        if len(self._buffer) != len(self._joints):
            self.wrong_size += 1
            self.deactivate()
            return
        self._interfaces.update(zip(self._joints, self._buffer, strict=True))


class JointStateBroadcaster:
    """joint_state_broadcaster/JointStateBroadcaster, from state interfaces to joint_states."""

    def __init__(self, joints: Sequence[str], frame_id: str = "") -> None:
        """Names come in the order of an unordered_map ([B] 259-271): here in a fixed odd one.

        `frame_id` is a parameter since 5.1.0 of the package, and was empty before.
        """
        self._frame_id = frame_id
        self.names = sorted(joints, key=lambda name: (sum(name.encode()) * 5) % 7)

    def message(self, stamp_ns: int, interfaces: Mapping[str, Mapping[str, float]]) -> JointState:
        """The message of one cycle: joint -> {position, velocity, effort} -> value.

        The stamp is the time that the manager gives ([B] 368), its clock when the cycle begins
        ([L] 121-123); an interface that the hardware does not have is NaN
        in all three arrays ([B] 302-305, 341-344), not an empty array.
        """
        message = JointState(name=self.names)
        message.header.frame_id = self._frame_id
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp_ns, 1_000_000_000)
        for field in ("position", "velocity", "effort"):
            values = [interfaces[name].get(field, NAN) for name in self.names]
            setattr(message, field, values)
        return message
