"""Forged wrenches at the tool, while every state waits for the true ones."""

from __future__ import annotations

from functools import partial

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import WrenchStamped

from benchmarks.faults.companions import send, send_raw, stamp_ahead
from benchmarks.faults.message_rows import COUNT, FOREVER
from benchmarks.faults.row import Bench, Inject, Row, nothing
from benchmarks.faults.session import Session

_NAN = float("nan")


def wrench(session: Session, force: float, ahead: float, stamp: Time | None) -> WrenchStamped:
    """Of the state `ahead` of the newest one [s], or of a stamp; the force [N] points up."""
    assert session.state is not None
    message = WrenchStamped()
    message.header.stamp = stamp or stamp_ahead(session.state.header.stamp, ahead)
    message.wrench.force.z = force
    return message


def wrenches(
    count: int,
    force: float,
    session: Session,
    _: np.random.Generator,
    ahead: float | None = None,
    stamp: Time | None = None,
) -> None:
    """So many, each of the next state unless said otherwise: before and behind the true one."""
    step = session.control_dt if ahead is None else ahead
    send(session, session.wrenches, count, lambda: wrench(session, force, step, stamp))


def raw(session: Session, _: np.random.Generator) -> None:
    """Bytes that are not a wrench."""
    send_raw(session, session.wrenches)


_FORGED: dict[str, Inject] = {
    "contacts/tool NaN": partial(wrenches, COUNT, _NAN),
    "contacts/tool 1e300 N": partial(wrenches, COUNT, 1e300),
    "contacts/tool 1e5 N": partial(wrenches, COUNT, 1e5),
    "contacts/tool 300 N": partial(wrenches, COUNT, 300.0),
    "contacts/tool stamp +1 h, 60 times": partial(wrenches, COUNT, 0.0, ahead=3600.0),
    "ONE contacts/tool stamp 2^31-1 s": partial(wrenches, 1, 0.0, stamp=Time(sec=FOREVER)),
    "ONE contacts/tool 1e5 N": partial(wrenches, 1, 1e5),
    "raw bytes on contacts/tool": raw,
    "baseline with wrenches": nothing,
}
_LASTING = ("NaN", "1e300", "1e5")

ROWS = tuple(
    Row(
        name,
        inject,
        "contacts",
        bench=Bench.TOUCH,
        # Where most states of a tenth of a second cannot be believed, the controller latches.
        latches=any(word in name for word in _LASTING) and not name.startswith("ONE"),
    )
    for name, inject in _FORGED.items()
)
