"""The messages of one simulated instant, in the order that readers rely on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ghc_controller.ros.wire.joint_state import JointStateEncoder
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.bridge.state_cdr import (
    OdometryEncoder,
    WrenchEncoder,
    encode_clock,
)

Publish = Callable[[Any], None]  # of serialized bytes or of a message
Observe = Callable[[ControlCycle], None]  # publishes the sensor reading of this cycle, if any

WORLD_FRAME = "world"


class StatePublisher:
    """Sensors first: a reader of a joint state can already have wrenches, odometry and obstacles
    of its stamp.

    The clock is last because the controller does not wait for it.
    """

    def __init__(
        self,
        joint_states: Publish,
        clock: Publish,
        contacts: Mapping[str, Publish],
        observe: Observe | None = None,
        odometry: Publish | None = None,
    ) -> None:
        """Publishers of the serialized messages; `contacts` by contact name, empty for none, and
        `odometry` for a robot with a floating base."""
        self._observe = observe
        self._joint_states = joint_states
        self._clock = clock
        self._contacts = dict(contacts)
        self._odometry = odometry
        self._wrench = WrenchEncoder(WORLD_FRAME)
        self._encoder: JointStateEncoder | None = None
        self._base: OdometryEncoder | None = None

    def publish(self, cycle: ControlCycle) -> None:
        """Send the current state of `cycle`."""
        if self._encoder is None:
            self._encoder = JointStateEncoder(cycle.simulator.joint_names, "")
            self._base = OdometryEncoder(WORLD_FRAME, cycle.simulator.base_frame)
        stamp, state, base = cycle.time_ns, cycle.state, cycle.base
        for name, send in self._contacts.items():
            send(self._wrench.encode(stamp, state.wrenches[name]))
        if self._observe is not None:
            self._observe(cycle)
        if self._odometry is not None and self._base is not None:
            self._odometry(self._base.encode(stamp, base.pose, base.velocity))
        q, v = cycle.measured
        self._joint_states(self._encoder.encode(stamp, cycle.simulator.torque, q, v))
        self._clock(encode_clock(stamp))
