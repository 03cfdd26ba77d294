"""All cases by name, in the order of the page."""

from __future__ import annotations

from functools import partial

from benchmarks.compare.case import Case
from benchmarks.compare.method import METHODS, UNDAMPED, Method
from benchmarks.compare.runs.scenario_loop import run_scenario
from benchmarks.compare.runs.ten_tasks import run_ten_tasks
from benchmarks.compare.runs.unreachable import run_unreachable
from benchmarks.compare.runs.upper_body import run_upper_body
from benchmarks.upper_body_cases import CASES as UPPER_BODY

UPPER_BODY_W = (1e-4, 1e-2)  # [-] regularization
_FEET = 12  # accelerations that two soles keep at rest
_LUNGES = {
    "near": "near target, no bounds",
    "far": "far target, no bounds",
    "near_bounds": "near target, bounds",
    "far_bounds": "far target, bounds",
}


def _arm(name: str, title: str, variant: str = "") -> Case:
    scenario = partial(run_scenario, name=name, variant=variant)
    figure = "none" if variant else "end"  # in a compromise no task is above the other
    return Case(name, f"KUKA, {title}", "KUKA", figure, scenario)


def _upper_body(name: str, w: float) -> Case:
    title = f"upper body {UPPER_BODY[name].title}, w = {w:g}"
    run = partial(run_upper_body, name=name, w=w)
    return Case(f"upper_body_{name}_w{w:g}", title, "upper body", "mean", run)


def _fencing(variant: str) -> Case:
    run = partial(run_scenario, name="fencing", variant=variant, last_quarter=True)
    title = f"fencing, {_LUNGES[variant]}"
    methods = METHODS | UNDAMPED
    if variant.endswith("bounds"):  # the scenario leaves it at the default there
        damping = {"velocity_damping": 0.0}
        methods = {
            name: Method(name, method.formulation, dict(method.changes) | damping)
            for name, method in methods.items()
        }
    return Case(f"fencing_{variant}", title, "fencing", "end", run, methods)


def _standing() -> Case:
    run = partial(run_scenario, name="priority_humanoid", held=_FEET, hold=1.0, control_dt=2e-3)
    return Case("standing", "iCub standing, priorities change", "standing", "end", run)


CASES = {
    case.name: case
    for case in (
        _arm("priority_switching", "four switches"),
        _arm("insertion_removal", "insertion and removal"),
        _arm("nonstrict", "a compromise, no order", "alpha_12_0.2"),
        Case("unreachable", "KUKA, target out of reach", "KUKA", "end", run_unreachable),
        *(_upper_body(name, w) for name in UPPER_BODY for w in UPPER_BODY_W),
        *map(_fencing, _LUNGES),
        Case("ten_tasks", "iCub, ten tasks in random order", "ten tasks", "end", run_ten_tasks),
        _standing(),
    )
}
