"""A request on its way while the bridge is restarted counts in the time of the new one."""

from __future__ import annotations

import time

import pytest
from ghc_msgs.msg import PriorityTransition, TransitionStatus

from benchmarks.mistakes.requests import Desk
from ghc_controller.ros.time import seconds_from_time

PATIENCE = 60.0  # [s] wall


@pytest.mark.parametrize(("before", "start"), [(0.25, 0.25), (100.0, 0.5)])
def test_a_request_without_a_stamp_starts_in_the_time_that_applies_it(
    before: float, start: float
) -> None:
    """Checked at 100 s, applied at 0.5 s: it does not wait until 100 s to move the robot."""
    desk = Desk(lockstep=False)
    desk.subscriber.at(before)
    desk.send(PriorityTransition(hierarchy="elbow > end_effector > posture", duration=0.2))
    deadline = time.monotonic() + PATIENCE
    while not desk.subscriber._queue._ready and time.monotonic() < deadline:
        time.sleep(0.01)
    desk.subscriber.at(0.5)
    desk.subscriber.close()
    (reply,) = [each for each in desk.replies if isinstance(each, TransitionStatus)]
    assert reply.status == TransitionStatus.ACCEPTED
    assert seconds_from_time(reply.start) == pytest.approx(start, abs=1e-9)
