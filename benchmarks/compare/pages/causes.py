"""Why `cascade` is less accurate than a method in a case: written by hand, by letter."""

from __future__ import annotations

from collections.abc import Iterable

UNKNOWN = "?"  # a loss whose cause was not examined
CAUSES = {
    "a": "The orientation counts as the mean over the run; what is left of it (1e-4 rad) is its "
    "lag while the arm moves, 1e-9 rad at the end of upper body 2. `hqp_transition` has as much. "
    "The others move the arm less: `weighted` and `balanced` end with the hand 0.7 to 1.8 mm off, "
    "`rhp_hqp` lets it go 2.5 times as far.",
    "b": "The mean includes the time in which the task is removed. Laws that know one order at a "
    "time switch when the share of the other order passes one half, so the hand is released for "
    "a shorter time, with torque rates 4 to 12 times as high; it ends 0.2 to 1.1 mm off, with "
    "`cascade` at most 0.03 mm.",
    "c": "`cascade` damps a level by the length of its rows, the others by one w; at w = 0.01 the "
    "arm then swings differently while the hand is released ([damping of a level]"
    "(architecture.md#damping-of-a-level)). `rhp_hqp` also lets the hand go earlier, and so keeps "
    "the elbow farther away.",
    "d": "`weighted` does not keep levels apart: for the task named it gives up the sword's tip "
    "(25 mm), a hand (13 mm) or the hand's target (4 mm) at a level below.",
    "e": "The error of the damping, 0.85 mm at w = 0.01 (`hqp`: 0.83). Without damping it is "
    "0.13 mm, and the far target without bounds stops the run; `operational_space` weights its "
    "damping with the inertia.",
    "f": "0.03 mm while the sword still moves along its bounds (`hqp`: 0.06). The others have one "
    "QP for all levels, which is not strict at a bound: the left foot, one level below, is off by "
    "25 to 60 times as much as with `cascade`.",
    "g": "The rest of an approach: the default `velocity_damping` of 20, which `cascade` has and "
    "the others lack, slows the end of a motion in what the levels above leave. With 0 `cascade` "
    "ends 0.07 and 0.12 mm off the two hands' targets, `hqp_transition` 0.09 and 0.15; "
    "`operational_space` weights its damping with the inertia.",
}
_OF: tuple[tuple[str, tuple[str, ...], str], ...] = (
    ("upper_body_reactive_w0.01", ("hqp_transition", "rhp_hqp"), "c"),
    ("upper_body_", ("operational_space", "resolved_acceleration", "task_priority"), "b"),
    ("upper_body_reactive", ("weighted",), "d"),
    ("upper_body_", ("balanced", "weighted", "rhp_hqp"), "a"),
    ("fencing_near_bounds", ("operational_space",), "e"),
    (
        "fencing_near_bounds",
        (
            "task_priority_undamped",
            "resolved_acceleration_undamped",
            "operational_space_undamped",
        ),
        "e",
    ),
    (
        "fencing_far_bounds",
        ("balanced", "resolved_acceleration", "task_priority", "ghc", "ghc_full"),
        "f",
    ),
    ("fencing_", ("weighted",), "d"),
    ("standing", ("weighted",), "d"),
    ("standing", ("hqp_transition", "operational_space", "rhp_hqp"), "g"),
)


def cause(case: str, method: str) -> str:
    """Letter of the cause, the first entry that fits; UNKNOWN if there is none."""
    for prefix, methods, letter in _OF:
        if case.startswith(prefix) and method in methods:
            return letter
    return UNKNOWN


def explained(letters: Iterable[str]) -> str:
    """A list of the causes named."""
    named = sorted(set(letters) - {UNKNOWN})
    return "\n".join(f"- **({letter})** {CAUSES[letter]}" for letter in named)
