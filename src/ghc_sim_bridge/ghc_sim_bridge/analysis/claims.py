"""What the controller said against what was recomputed from the log."""

from __future__ import annotations

import numpy as np

from ghc_controller.errors import GhcError
from ghc_sim_bridge.analysis.task_errors import RunHistory
from ghc_sim_bridge.logs.controller_trace import ControllerTrace

_SAME_REFERENCE = 1e-6  # [m] or [rad]
_SAME_TIME = 1e-6  # [s]


def check_references(history: RunHistory, trace: ControllerTrace) -> None:
    """Raise GhcError when the controller followed another reference than the scripted one.

    The state of time zero is left out: it is answered before the references are sent, and again
    when they have come.
    """
    for index, task in enumerate(history.tasks):
        for row, message in _common(history, trace):
            followed = np.array(trace.references[message][index])
            if np.abs(followed - task.reference[row]).max() > _SAME_REFERENCE:
                raise GhcError(
                    f"task '{task.name}': the controller followed the reference "
                    f"{followed.tolist()} at t = {history.time[row]:g} s, "
                    f"{task.reference[row].tolist()} was sent; its log says why"
                )


def error_disagreement(history: RunHistory, trace: ControllerTrace) -> dict[str, float]:
    """Largest difference of each task's error as reported and as recomputed [m] or [rad]."""
    pairs = _common(history, trace)
    return {
        task.name: max(
            (abs(trace.errors[message][index] - float(task.error[row])) for row, message in pairs),
            default=0.0,
        )
        for index, task in enumerate(history.tasks)
    }


def _common(history: RunHistory, trace: ControllerTrace) -> list[tuple[int, int]]:
    """Pairs of (row of the history, message) with the same simulated time above zero."""
    times = np.array(trace.time)
    rows = np.searchsorted(history.time, times - _SAME_TIME)
    return [
        (int(row), message)
        for message, row in enumerate(rows)
        if times[message] > 0.0
        and row < len(history.time)
        and abs(history.time[row] - times[message]) < _SAME_TIME
    ]
