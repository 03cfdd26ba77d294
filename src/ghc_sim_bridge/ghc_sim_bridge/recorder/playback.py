"""Order and times at which a recording is published again; no ROS here."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.bag_reading import raw_messages


class Entry(NamedTuple):
    """One message to be published."""

    position: int  # [ns] since the first message of the recording; never falls
    log_time: int  # [ns] as recorded: simulated time if there was any
    topic: str
    data: bytes


@dataclass(frozen=True, slots=True)
class Contents:
    """Content of the intact part of a recording."""

    topics: dict[str, BagTopic]  # by name, in the order of the file
    messages: int
    duration: int  # [ns]


def is_latched(topic: BagTopic) -> bool:
    """Whether late subscribers receive the last messages too (latched)."""
    return any(qos.get("durability") == "transient_local" for qos in topic.offered_qos)


def contents(path: Path) -> Contents:
    """Read a recording once for its content.

    Raises:
        ConfigurationError: it cannot be read, or holds no message.
    """
    topics: dict[str, BagTopic] = {}
    count = end = 0
    for topic, entry in _entries(path):
        topics.setdefault(topic.name, topic)
        if entry is not None:
            count, end = count + 1, entry.position
    if not count:
        raise ConfigurationError(f"recording '{path}': it holds no message")
    return Contents(topics, count, end)


def chosen(known: Contents, names: Collection[str]) -> dict[str, BagTopic]:
    """The topics of these names, with a slash in front or without one; all without names.

    Raises:
        UnknownName: a topic that the recording has not; lists those that it has.
    """
    wanted = ["/" + name.removeprefix("/") for name in names]
    for name in wanted:
        if name not in known.topics:
            raise UnknownName("topic of the recording", name, known.topics)
    return {name: topic for name, topic in known.topics.items() if not wanted or name in wanted}


def playback(path: Path, topics: Collection[str], start: float) -> Iterator[Entry]:
    """Messages of `topics` from `start` [s] after the first one on, in their order.

    The last message of a latched topic before `start` comes first, even if nothing follows.
    Raises as `contents`.
    """
    begin = round(start * NANOSECONDS)
    latched: dict[str, deque[Entry]] = {}
    for topic, entry in _entries(path):
        if topic.name not in topics:
            continue
        if entry is None:
            if is_latched(topic):
                depth = max(int(qos.get("depth", 1)) for qos in topic.offered_qos)
                latched.setdefault(topic.name, deque(maxlen=max(depth, 1)))
        elif entry.position >= begin:
            yield from (early._replace(position=begin) for early in _emptied(latched))
            yield entry
        elif topic.name in latched:
            latched[topic.name].append(entry)
    yield from (early._replace(position=begin) for early in _emptied(latched))


def _emptied(latched: dict[str, deque[Entry]]) -> Iterator[Entry]:
    for kept in latched.values():
        while kept:
            yield kept.popleft()


def _entries(path: Path) -> Iterator[tuple[BagTopic, Entry | None]]:
    """All messages with their positions: where time went back, none has passed."""
    position, before = 0, None
    for topic, message in raw_messages(path):
        if message is None:
            yield topic, None
            continue
        position += max(0, message.log_time - (message.log_time if before is None else before))
        before = message.log_time
        yield topic, Entry(position, message.log_time, topic.name, message.data)


class Pace:
    """Which messages are due on a clock that runs `rate` times as fast as the recording."""

    def __init__(self, begin: Callable[[], Iterator[Entry]], rate: float, loop: bool) -> None:
        """`begin` opens the recording; with `loop` it is opened again at its end."""
        self._begin = begin
        self._rate = rate
        self._loop = loop
        self._entries = begin()
        self._next = next(self._entries, None)
        self._first = 0 if self._next is None else self._next.position
        self._wall_start: int | None = None

    @property
    def done(self) -> bool:
        """Whether all messages were returned."""
        return self._next is None

    def due(self, wall: int) -> Iterator[Entry]:
        """Messages up to the time `wall` [ns]; the first call is the time of the first one."""
        if self._wall_start is None:
            self._wall_start = wall
        now = self._first + round((wall - self._wall_start) * self._rate)
        while self._next is not None and self._next.position <= now:
            yield self._next
            self._next = next(self._entries, None)
            if self._next is None and self._loop:
                self._entries = self._begin()
                self._next = next(self._entries, None)
                self._wall_start = wall
                return
