"""Times of a recording follow /clock, but no single time that is far ahead of it."""

from __future__ import annotations

from ghc_sim_bridge.recorder.timeline import IN_A_ROW, RecordingTimeline

SECOND = 1_000_000_000


def _logged(timeline: RecordingTimeline) -> int:
    times: list[int] = []
    timeline.write(0, times.append)
    return times[0]


def test_a_forged_clock_moves_no_message() -> None:
    timeline = RecordingTimeline(0, lambda: None)
    for k in range(1, 50):
        timeline.clock(k * SECOND // 100)
        for _ in range(2):
            timeline.clock(10**6 * SECOND)
        assert _logged(timeline) == k * SECOND // 100


def test_forged_times_between_true_ones_are_not_in_a_row() -> None:
    timeline = RecordingTimeline(0, lambda: None)
    for k in range(1, 50):
        timeline.clock(k * SECOND // 100)
        timeline.clock(10**6 * SECOND + k)
        assert _logged(timeline) == k * SECOND // 100


def test_a_run_that_goes_on_elsewhere_is_followed() -> None:
    """Ahead after some messages; back at once, as after a reset."""
    timeline = RecordingTimeline(0, lambda: None)
    timeline.clock(SECOND)
    for k in range(IN_A_ROW):
        timeline.clock(500 * SECOND + k)
    assert _logged(timeline) == 500 * SECOND + IN_A_ROW - 1
    timeline.clock(SECOND)
    assert _logged(timeline) == SECOND
