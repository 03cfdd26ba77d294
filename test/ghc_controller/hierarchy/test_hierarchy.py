"""Priority matrices, hierarchy strings, transitions and their schedule."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.errors import GhcError
from ghc_controller.hierarchy import (
    PriorityMatrix,
    Profile,
    Transition,
    TransitionPhase,
    TransitionSchedule,
    format_hierarchy,
    matrix_from_hierarchy,
)

TASKS = ("end_effector", "elbow", "posture")


def _schedule(start: str = "end_effector > elbow > posture") -> TransitionSchedule:
    return TransitionSchedule(matrix_from_hierarchy(TASKS, start), lambda _: 1.0)


def _to(hierarchy: str, start: float, duration: float, name: str = "") -> Transition:
    return Transition(matrix_from_hierarchy(TASKS, hierarchy), start, duration, id=name)


def test_strict_string() -> None:
    """`a > b`: alpha[b, a] = 1 and alpha[a, b] = 0, for every pair down the string."""
    matrix = matrix_from_hierarchy(TASKS, "posture > elbow > end_effector")
    assert np.array_equal(matrix.alpha, [[0, 1, 1], [0, 0, 1], [0, 0, 0]])


def test_equal_tasks_share_the_compromise() -> None:
    """`a = b` is 0.5 both ways."""
    alpha = matrix_from_hierarchy(TASKS, "end_effector = elbow > posture").alpha
    assert alpha[0, 1] == alpha[1, 0] == 0.5
    assert alpha[2, 0] == alpha[2, 1] == 1.0


def test_left_out_task_is_removed() -> None:
    """Its whole row 1, its column 0 elsewhere."""
    alpha = matrix_from_hierarchy(TASKS, "end_effector > posture").alpha
    assert np.array_equal(alpha[1], [1, 1, 1])
    assert np.array_equal(alpha[[0, 2], 1], [0, 0])


@pytest.mark.parametrize(
    "text", ["end_effector > elbow > posture", "elbow", "posture = elbow > end_effector"]
)
def test_string_round_trip(text: str) -> None:
    """A matrix made from a string formats to a string of the same matrix."""
    matrix = matrix_from_hierarchy(TASKS, text)
    again = matrix_from_hierarchy(TASKS, format_hierarchy(matrix))
    assert np.array_equal(matrix.alpha, again.alpha)


def test_matrix_without_a_string() -> None:
    """A non-strict pair that no string can say formats to nothing."""
    alpha = matrix_from_hierarchy(TASKS, "end_effector > elbow > posture").alpha.copy()
    alpha[0, 1], alpha[1, 0] = 0.2, 0.8
    assert format_hierarchy(PriorityMatrix(TASKS, alpha)) == ""


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ["malformed", "expected"]),
        ("elbow >", ["malformed", "elbow >"]),
        ("elbow < posture", ["malformed", "elbow < posture"]),
        ("elbow > elbow", ["elbow", "more than once"]),
        ("elbow > wrist", ["wrist", "end_effector, elbow, posture"]),
    ],
)
def test_bad_strings_are_explained(text: str, words: list[str]) -> None:
    """The message names what was given and what was expected or exists."""
    with pytest.raises(GhcError) as caught:
        matrix_from_hierarchy(TASKS, text)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize(
    ("tasks", "alpha", "words"),
    [
        (["elbow"], [0.0, 0.0], ["1 tasks", "size 2 given", "1 expected"]),
        (["wrist"], [0.0], ["wrist", "end_effector, elbow, posture"]),
        (["elbow"], [float("nan")], ["alpha[elbow, elbow]", "nan", "[0, 1]"]),
        (["elbow", "posture"], [0, 1.5, 0, 0], ["alpha[elbow, posture]", "1.5"]),
        (["elbow", "elbow"], [0, 0, 0, 0], ["must differ"]),
    ],
)
def test_bad_matrices_are_explained(
    tasks: list[str], alpha: list[float], words: list[str]
) -> None:
    """Wrong size, unknown task, NaN and values outside [0, 1]."""
    with pytest.raises(GhcError) as caught:
        PriorityMatrix.from_rows(TASKS, tasks, alpha)
    for word in words:
        assert word in str(caught.value)


def test_matrix_over_some_tasks_removes_the_others() -> None:
    """Tasks may come in any order; those left out are removed."""
    matrix = PriorityMatrix.from_rows(TASKS, ["posture", "end_effector"], [0, 1, 0, 0])
    expected = matrix_from_hierarchy(TASKS, "end_effector > posture")
    assert np.array_equal(matrix.alpha, expected.alpha)


def test_alpha_is_read_only() -> None:
    """A matrix in force cannot be changed behind the schedule's back."""
    with pytest.raises(ValueError, match="read-only"):
        matrix_from_hierarchy(TASKS, "elbow").alpha[0, 0] = 0.0


@pytest.mark.parametrize("profile", list(Profile))
def test_profiles_rise_from_zero_to_one(profile: Profile) -> None:
    """Monotone, exact ends, symmetric: alpha_ij + alpha_ji stays 1 on the ramp (eq. 15)."""
    s = np.linspace(-0.1, 1.1, 241)
    values = np.array([profile.progress(float(value)) for value in s])
    assert values[0] == 0.0
    assert values[-1] == 1.0
    assert (np.diff(values) >= 0.0).all()
    assert np.allclose(values + values[::-1], 1.0, atol=1e-12)


def test_unknown_profile_lists_the_known() -> None:
    """The rejection names the profiles that exist."""
    with pytest.raises(GhcError, match="cosine, linear, minimum_jerk"):
        Profile.parse("cubic")


@pytest.mark.parametrize("duration", [-1.0, float("nan"), float("inf")])
def test_bad_duration(duration: float) -> None:
    """Negative or non-finite durations are rejected with the value."""
    with pytest.raises(GhcError, match="duration"):
        _to("elbow", 0.0, duration)


def test_ramp_follows_equation_15() -> None:
    """Halfway a swapped pair stands at 0.5; at the end the target is exact."""
    schedule = _schedule()
    schedule.add(_to("elbow > end_effector > posture", 1.0, 2.0), 0.0)
    assert not schedule.advance(0.999)
    schedule.advance(1.5)
    share = 0.5 - 0.5 * np.cos(np.pi * 0.25)
    assert np.isclose(schedule.alpha[0, 1], share, atol=1e-15)
    assert np.isclose(schedule.alpha[1, 0], 1.0 - share, atol=1e-15)
    phases = [event.phase for event in schedule.advance(3.0)]
    assert phases == [TransitionPhase.DONE]
    assert np.array_equal(schedule.alpha, schedule.target.alpha)


def test_newest_transition_starts_from_the_alpha_in_force() -> None:
    """No jump where one ramp takes over from another; the old one ends PREEMPTED."""
    schedule = _schedule()
    schedule.add(_to("elbow > end_effector > posture", 0.0, 2.0, "first"), 0.0)
    schedule.add(_to("posture > elbow > end_effector", 1.0, 2.0, "second"), 0.0)
    previous = schedule.alpha
    seen = []
    for time in np.arange(0.0, 3.2, 1e-3):
        seen += [(event.transition.id, event.phase.value) for event in schedule.advance(time)]
        assert np.abs(schedule.alpha - previous).max() < 2e-3
        previous = schedule.alpha
    assert seen == [
        ("first", "ACTIVE"),
        ("first", "PREEMPTED"),
        ("second", "ACTIVE"),
        ("second", "DONE"),
    ]


def test_the_result_does_not_depend_on_the_sampling() -> None:
    """A late look gives the matrix that many small steps would have given."""
    fine, coarse = _schedule(), _schedule()
    for schedule in (fine, coarse):
        schedule.add(_to("elbow > posture", 0.3, 1.0), 0.0)
        schedule.add(_to("posture", 0.9, 1.0), 0.0)
    for time in np.arange(0.0, 1.5, 1e-3):
        fine.advance(float(time))
    fine.advance(1.5)
    coarse.advance(1.5)
    assert np.allclose(fine.alpha, coarse.alpha, atol=1e-12)


@pytest.mark.parametrize("late", [0.1, 1.0, 30.0])
def test_a_late_transition_begins_now_and_alpha_does_not_jump(late: float) -> None:
    """Its start has passed, also that of the running ramp: both begin where alpha stands."""
    schedule = _schedule()
    schedule.add(_to("elbow > end_effector > posture", 5.0, 2.0), 0.0)
    schedule.advance(6.0)
    before = np.array(schedule.alpha)
    schedule.add(_to("posture > elbow > end_effector", 6.0 - late, 2.0), 6.0)
    schedule.advance(6.001)
    assert np.abs(schedule.alpha - before).max() < 1e-3
    schedule.advance(8.0)
    assert schedule.is_settled


def test_a_late_request_after_a_cancel_ramps_from_the_initial_matrix() -> None:
    """Its start lies before the cancel: it starts there, and alpha does not jump."""
    schedule = _schedule()
    initial = schedule.alpha.copy()
    schedule.add(_to("elbow > end_effector > posture", 0.0, 2.0), 0.0)
    schedule.advance(1.0)
    (event,) = schedule.cancel(1.0)
    assert event.phase is TransitionPhase.PREEMPTED
    assert np.array_equal(schedule.alpha, initial)
    wanted = _to("posture > elbow > end_effector", 0.0, 2.0)
    schedule.add(wanted, 1.0)
    before = schedule.alpha.copy()
    for tick in range(2001):
        schedule.advance(1.0 + 1e-3 * tick)
        assert np.abs(schedule.alpha - before).max() < 2e-3
        before = schedule.alpha.copy()
    assert np.array_equal(schedule.alpha, wanted.target.alpha)


def test_zero_duration_switches_at_once() -> None:
    """Duration 0: the target from the very tick of the start."""
    schedule = _schedule()
    schedule.add(_to("elbow", 0.5, 0.0), 0.0)
    events = [event.phase for event in schedule.advance(0.5)]
    assert events == [TransitionPhase.ACTIVE, TransitionPhase.DONE]
    assert np.array_equal(schedule.alpha, matrix_from_hierarchy(TASKS, "elbow").alpha)


def test_repeat_of_the_active_target_is_recognised() -> None:
    """`ros2 topic pub` repeats: the same target again changes nothing."""
    schedule = _schedule()
    wanted = _to("elbow > posture", 0.0, 1.0)
    assert not schedule.is_repeat(wanted)
    schedule.add(wanted, 0.0)
    schedule.advance(0.2)
    assert schedule.is_repeat(_to("elbow > posture", 0.2, 1.0))
    settled = [schedule.is_settled]
    schedule.advance(2.0)
    settled.append(schedule.is_settled)
    assert settled == [False, True]
    assert schedule.is_repeat(_to("elbow > posture", 2.0, 1.0))
    assert not schedule.is_repeat(_to("elbow", 2.0, 1.0))
    schedule.add(_to("elbow", 3.0, 1.0), 2.0)
    assert schedule.is_repeat(_to("elbow", 3.0, 1.0))
    assert not schedule.is_repeat(_to("elbow", 4.0, 1.0))
    assert not schedule.is_repeat(_to("elbow > posture", 2.0, 1.0))


def test_unsolvable_target_is_refused() -> None:
    """Where [P_1 .. P_k] loses rank on the ramp the rejection cites eq. 13b and the tasks."""
    start = matrix_from_hierarchy(TASKS, "end_effector > elbow > posture")
    schedule = TransitionSchedule(start, lambda alpha: float(1.0 - np.diag(alpha).min()))
    circle = PriorityMatrix(TASKS, np.ones((3, 3)) - np.diag([0.0, 0.0, 1e-4]))
    with pytest.raises(GhcError, match=r"13b.*end_effector, elbow, posture"):
        schedule.check_solvable(Transition(circle, 0.0, 1.0))
    nothing = PriorityMatrix(TASKS, np.ones((3, 3)))
    with pytest.raises(GhcError, match=r"no task is left.*end_effector, elbow, posture"):
        schedule.check_solvable(Transition(nothing, 0.0, 1.0))
