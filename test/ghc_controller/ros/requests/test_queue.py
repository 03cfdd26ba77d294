"""Requests wait for a state, in the order of their arrival, and never without a limit."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest

from ghc_controller.ros.requests import queue
from ghc_controller.ros.requests.queue import RequestQueue

Applied = list[tuple[str, float, str]]  # what, time of the state, thread that prepared it


def queue_of(lockstep: bool) -> tuple[RequestQueue, Applied, list[str]]:
    applied: Applied = []
    lost: list[str] = []

    def prepare(topic: str, data: bytes) -> Callable[[float], None]:
        thread = threading.current_thread().name
        return lambda now: applied.append((topic + data.decode(), now, thread))

    return RequestQueue(prepare, lockstep, lambda field, _: lost.append(field)), applied, lost


def test_in_lockstep_requests_wait_for_the_first_state_and_then_apply_at_once() -> None:
    requests, applied, _ = queue_of(lockstep=True)
    requests.start()
    assert requests.put("a", b"1") and requests.put("a", b"2") and not applied
    requests.apply(0.5)
    requests.put("a", b"3")
    here = threading.current_thread().name
    assert applied == [(f"a{k}", 0.5, here) for k in (1, 2, 3)]


def test_in_real_time_a_thread_prepares_and_a_state_applies_a_few() -> None:
    requests, applied, _ = queue_of(lockstep=False)
    for k in range(6):
        assert requests.put("a", str(k).encode())
    assert not applied
    requests.start()
    for state in range(2000):
        before = len(applied)
        requests.apply(float(state))
        assert len(applied) - before <= 4
        if len(applied) == 6:
            break
        threading.Event().wait(1e-3)
    requests.close()
    assert [(what, thread) for what, _, thread in applied] == [
        (f"a{k}", "requests") for k in range(6)
    ]


def test_what_finds_no_room_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(queue, "MOST_WAITING", 3)
    requests, applied, lost = queue_of(lockstep=True)
    for k in range(5):
        requests.put("a", str(k).encode())
    requests.apply(0.0)
    assert [what for what, *_ in applied] == ["a2", "a3", "a4"]  # the newest ones
    assert lost == ["requests"] * 2
    requests, _, _ = queue_of(lockstep=False)  # its thread has not started
    assert [requests.put("a", b"") for _ in range(4)] == [True, True, True, False]


def test_what_is_kept_for_the_next_run_is_taken_once() -> None:
    requests, applied, _ = queue_of(lockstep=True)
    requests.apply(0.0)
    requests.keep("a", b"1")
    assert not applied
    assert requests.take_kept() == [("a", b"1")]
    assert requests.take_kept() == []
