"""Publishing that waits for slow readers instead of losing a message."""

from __future__ import annotations

import time
from collections.abc import Callable

from ghc_sim_bridge.bridge.lockstep import PartnerMissing

Publish = Callable[[bytes], None]

# The middleware itself waits about 0.1 s for room in its history; this only spares it a busy loop.
PAUSE = 0.001  # [s]


def patient(publish: Publish, topic: str, timeout: float, stopping: Callable[[], bool]) -> Publish:
    """`publish`, tried again while its history is full of what a reliable reader did not take.

    The returned function raises PartnerMissing after `timeout` [s] of that; while the node is
    `stopping` the message is dropped.
    """

    def publish_patiently(data: bytes) -> None:
        began = time.monotonic()
        while not stopping():
            try:
                publish(data)
            except RuntimeError as error:  # root of rclpy's errors
                if time.monotonic() - began > timeout:
                    raise PartnerMissing(
                        f"a reader of '{topic}' took nothing for {timeout:g} s, and with "
                        f"'lossless' no message may be dropped: {error}"
                    ) from error
                time.sleep(PAUSE)
            else:
                return

    return publish_patiently
