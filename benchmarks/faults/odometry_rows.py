"""Forged odometry of a humanoid that stands: every state waits for that of its stamp."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from nav_msgs.msg import Odometry

from benchmarks.faults.companions import send, send_raw, stamp_ahead
from benchmarks.faults.message_rows import COUNT, FOREVER
from benchmarks.faults.row import Bench, Inject, Row, nothing
from benchmarks.faults.session import Session

_NAN = float("nan")


def odometry(session: Session, ahead: float, stamp: Time | None, **changes: float) -> Odometry:
    """As the newest one, of the state `ahead` of it [s] or of a stamp, with numbers changed.

    Args:
        changes: `x` and `speed` are added to position and velocity along x [m], [m/s]; `turn` is
            the scale of the quaternion.
    """
    true = session.odometry
    assert true is not None
    message = Odometry(child_frame_id="forged")
    message.header.frame_id = true.header.frame_id
    message.header.stamp = stamp or stamp_ahead(true.header.stamp, ahead)
    place, twist, turn = message.pose.pose, message.twist.twist, true.pose.pose.orientation
    given, scale = true.pose.pose.position, changes.get("turn", 1.0)
    place.position.x = given.x + changes.get("x", 0.0)
    place.position.y, place.position.z = given.y, given.z
    twist.linear.x = true.twist.twist.linear.x + changes.get("speed", 0.0)
    for axis in "xyzw":
        setattr(place.orientation, axis, scale * getattr(turn, axis))
    return message


def forge(
    count: int,
    session: Session,
    _: np.random.Generator,
    ahead: float | None = None,
    stamp: Time | None = None,
    **changes: Any,
) -> None:
    """So many, each of the next state unless said otherwise: before and behind the true one."""
    step = session.control_dt if ahead is None else ahead
    send(session, session.odometry_out, count, lambda: odometry(session, step, stamp, **changes))


def raw(session: Session, _: np.random.Generator) -> None:
    """Bytes that are no odometry."""
    send_raw(session, session.odometry_out)


_FORGED: dict[str, Inject] = {
    "odom NaN": partial(forge, COUNT, x=_NAN),
    "odom 1e300 m": partial(forge, COUNT, x=1e300),
    "odom +3 m": partial(forge, COUNT, x=3.0),
    "odom 50 m/s": partial(forge, COUNT, speed=50.0),
    "odom quaternion of zeros": partial(forge, COUNT, turn=0.0),
    "odom stamp +1 h, 60 times": partial(forge, COUNT, ahead=3600.0),
    "ONE odom +3 m": partial(forge, 1, x=3.0),
    "ONE odom stamp 2^31-1 s": partial(forge, 1, stamp=Time(sec=FOREVER)),
    "raw bytes on odom": raw,
    "baseline with odometry": nothing,
}
_STAMPS = ("stamp", "baseline", "raw")

ROWS = tuple(
    Row(
        name,
        inject,
        "odometry",
        moving=False,
        bench=Bench.BASE,
        # Where most states of a tenth of a second cannot be believed, the controller latches.
        latches=not name.startswith("ONE") and not any(word in name for word in _STAMPS),
    )
    for name, inject in _FORGED.items()
)
