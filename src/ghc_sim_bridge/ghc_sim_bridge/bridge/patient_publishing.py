"""Publishing that waits for slow readers instead of losing a message."""

from __future__ import annotations

import time
from collections.abc import Callable

from ghc_sim_bridge.bridge.lockstep import PartnerMissing

Publish = Callable[[bytes], None]

# The middleware itself waits about 0.1 s for space in its history; this avoids a busy loop.
PAUSE = 0.001  # [s]


def patient(publish: Publish, topic: str, timeout: float, stopping: Callable[[], bool]) -> Publish:
    """`publish`, retried while its history is full of messages that a reliable reader did not
    take.

    The returned function raises PartnerMissing after `timeout` [s]; while the node is
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
