"""A recording that is written to the disk continuously and survives a full disk."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.bag_recording import BagRecording
from ghc_sim_bridge.recorder.timeline import RecordingTimeline

CHECKPOINT_PERIOD = 0.5  # [s] wall; a kill costs at most this much, and a write


class KeptRecording:
    """Takes messages with their wall time and writes a bag on the timeline of the simulation. A
    disk error ends the recording, not its caller: data on the disk are kept, `warn` is called with
    one line, later messages are dropped, and `close` raises the error.
    """

    def __init__(self, folder: Path, warn: Callable[[str], None]) -> None:
        """Create an empty bag.

        Raises:
            OSError: it cannot be written there.
        """
        self._bag = BagRecording(folder)
        self._timeline = RecordingTimeline(time.time_ns(), self._bag.restart)
        self._warn = warn
        self._failure: OSError | None = None
        self._due = time.monotonic() + CHECKPOINT_PERIOD

    @property
    def ended(self) -> bool:
        """Whether a disk error has ended it."""
        return self._failure is not None

    def add_topic(self, topic: BagTopic) -> None:
        """Declare a topic, before its messages."""
        if not self.ended:
            self._bag.add_topic(topic)

    def clock(self, stamp_ns: int) -> None:
        """Simulated time is `stamp_ns` [ns]."""
        if not self.ended:
            self._guard(partial(self._timeline.clock, stamp_ns))

    def write(self, topic: str, data: bytes) -> None:
        """Add a message that was received now."""
        if not self.ended:
            now_ns = time.time_ns()
            # The wall time of reception stands for that of publication.
            self._timeline.write(
                now_ns, lambda log_time_ns: self._bag.write(topic, log_time_ns, now_ns, data)
            )
            self.checkpoint_if_due()

    def checkpoint_if_due(self) -> None:
        """Write all messages so far to the disk, CHECKPOINT_PERIOD after the last time."""
        if not self.ended and time.monotonic() >= self._due:
            self._guard(self._bag.checkpoint)
            self._due = time.monotonic() + CHECKPOINT_PERIOD

    def close(self) -> None:
        """Write the rest and the index.

        Raises:
            OSError: not all of it could be written, now or before.
        """
        if self._failure is not None:
            raise self._failure
        self._bag.close()

    def _guard(self, write: Callable[[], None]) -> None:
        try:
            write()
        except OSError as error:
            self._failure = error
            self._bag.abandon()
            self._warn(
                f"recording ends here, the run goes on: {self._bag.path}: {error.strerror}; "
                "what was on the disk before is kept"
            )
