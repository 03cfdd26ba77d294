"""What the controller reports against what the log says."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.errors import GhcError
from ghc_sim_bridge.analysis.claims import check_references, error_disagreement
from ghc_sim_bridge.analysis.task_errors import RunHistory, TaskHistory
from ghc_sim_bridge.logs.controller_trace import ControllerTrace

TIME = np.arange(50) * 0.01


def history() -> RunHistory:
    """One task that stays 0.1 m away from a moving reference."""
    reference = np.column_stack([np.sin(TIME), np.cos(TIME), TIME])
    task = TaskHistory(
        "hand",
        "m",
        np.full(len(TIME), 0.1),
        reference - [0.1, 0.0, 0.0],
        reference,
        None,
        None,
        None,
    )
    return RunHistory(np.arange(len(TIME)), TIME, (task,), np.zeros((len(TIME), 1)))


def trace(reference_shift: float = 0.0, error: float = 0.1) -> ControllerTrace:
    """Reports of every second row, with an old reference at time zero."""
    run = history()
    result = ControllerTrace(tasks=("hand",))
    for k in range(0, len(TIME), 2):
        shift = 9.0 if k == 0 else reference_shift
        result.time.append(float(TIME[k]))
        result.references.append([(run.tasks[0].reference[k] + shift).tolist()])
        result.errors.append([error])
    return result


def test_the_scripted_reference_passes_whatever_was_followed_before_it_came() -> None:
    check_references(history(), trace())


def test_another_reference_is_an_error_that_names_task_and_time() -> None:
    with pytest.raises(GhcError, match=r"task 'hand': .* at t = 0\.02 s"):
        check_references(history(), trace(reference_shift=1e-3))


def test_disagreement_is_the_largest_difference() -> None:
    assert error_disagreement(history(), trace())["hand"] == pytest.approx(0.0)
    assert error_disagreement(history(), trace(error=0.13))["hand"] == pytest.approx(0.03)


def test_reports_between_the_rows_are_left_out() -> None:
    late = trace(reference_shift=1.0)
    late.time = [time + 0.003 for time in late.time]
    check_references(history(), late)
    assert error_disagreement(history(), late) == {"hand": 0.0}
