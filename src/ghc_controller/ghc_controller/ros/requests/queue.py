"""Queue between the arrival of requests and the states at which they are applied.

In real time a separate thread prepares requests (deserializes, parses, checks); the control
thread only applies those that are ready, a few per state. In lockstep simulated time stops
meanwhile, and requests are prepared and applied at once, so that a run does not depend on thread
scheduling.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from queue import Empty, Full, Queue
from threading import Event, Thread

MOST_WAITING = 4096  # [-] requests that wait for a state, or for the thread
_MOST_PER_STATE = 4  # [-] requests applied per state in real time
_CLOSING = 1.0  # [s] wall, for the request in the thread

Ready = Callable[[float], None]  # applies a request at a time [s]
Prepare = Callable[[str, bytes], Ready]


class RequestQueue:
    """Serialized requests on the way to a state; those before the first state wait for it."""

    def __init__(
        self, prepare: Prepare, lockstep: bool, reject: Callable[[str, str], object]
    ) -> None:
        """`prepare` turns topic and bytes into what is applied; `reject` is told what is lost."""
        self._prepare = prepare
        self._lockstep = lockstep
        self._reject = reject
        self._ready: deque[Ready] = deque()  # prepared, for the next state
        self._early: deque[tuple[str, bytes]] = deque(maxlen=MOST_WAITING)  # for the next run
        self._incoming: Queue[tuple[str, bytes]] = Queue(MOST_WAITING)
        self._closed = Event()
        self._thread: Thread | None = None
        self.now: float | None = None  # [s] of the last state; None before the first

    def start(self) -> None:
        """Start the thread; in lockstep there is none."""
        if not self._lockstep:
            self._thread = Thread(target=self._work, name="requests", daemon=True)
            self._thread.start()

    def close(self) -> None:
        """End the thread: it would keep the controller beyond the end of the interpreter."""
        self._closed.set()
        if self._thread is not None:
            self._thread.join(_CLOSING)

    def put(self, topic: str, data: bytes) -> bool:
        """Queue a request of the current run; False if there is no room for it."""
        if self._lockstep:
            self._put_prepared(self._prepare(topic, data))
            return True
        try:
            self._incoming.put_nowait((topic, data))
        except Full:
            return False
        return True

    def keep(self, topic: str, data: bytes) -> None:
        """Keep a request that belongs to the next run."""
        self._early.append((topic, data))

    def take_kept(self) -> list[tuple[str, bytes]]:
        """What was kept for the run that begins; it is kept no longer."""
        early = list(self._early)
        self._early.clear()
        return early

    def apply(self, now: float) -> None:
        """Apply the requests that are ready at the state of time `now` [s]."""
        self.now = now
        left = MOST_WAITING if self._lockstep else _MOST_PER_STATE
        while self._ready and left:
            self._ready.popleft()(now)
            left -= 1

    def _put_prepared(self, ready: Ready) -> None:
        """In lockstep: apply at once, or queue for the first state."""
        if self.now is not None:
            ready(self.now)
            return
        if len(self._ready) >= MOST_WAITING:
            self._ready.popleft()
            self._reject("requests", f"more than {MOST_WAITING} wait: the oldest one is dropped")
        self._ready.append(ready)

    def _work(self) -> None:
        while not self._closed.is_set():
            try:
                topic, data = self._incoming.get(timeout=_CLOSING / 4)
            except Empty:
                continue
            while len(self._ready) >= MOST_WAITING and not self._closed.is_set():
                try:
                    dropped, _ = self._incoming.get(timeout=0.01)  # no state comes
                    self._reject(dropped, f"more than {MOST_WAITING} requests wait: dropped")
                except Empty:
                    continue
            self._ready.append(self._prepare(topic, data))
