"""The section `walk` of a scenario file."""

from __future__ import annotations

from ghc_controller.schema.reader import Fields
from ghc_sim_bridge.scenario.walk.walk import Foot, Walk

_SHORTEST = 0.05  # [s] of a swing


def read_walk(fields: Fields) -> Walk:
    """The walk of a scenario.

    Raises ConfigurationError (file, field, what was given).
    """
    first, second = (_read_foot(item) for item in fields.sections("feet", size=2))
    steps = fields.number("steps", minimum=1.0)
    if steps != int(steps):
        raise fields.error("steps", f"a whole number expected, {steps:g} given")
    walk = Walk(
        task=fields.text("task"),
        center_of_mass=fields.vector("center_of_mass", 3),
        feet=(first, second),
        start=fields.number("start", minimum=0.1),
        steps=int(steps),
        length=fields.number("length"),
        height=fields.number("height", minimum=0.0),
        step_time=fields.number("step_time", minimum=_SHORTEST),
        double_support=fields.number("double_support", minimum=0.01),
        settle=fields.number("settle", 0.05, minimum=0.0),
        force_upper=fields.number("force_upper", minimum=0.0),
        force_unloaded=fields.number("force_unloaded", minimum=0.0),
    )
    if walk.center_of_mass[2] <= 0.0:
        given = walk.center_of_mass[2]
        raise fields.error("center_of_mass", f"a height above 0 expected, {given:g} given")
    swing = walk.step_time - walk.double_support - walk.settle
    if swing < _SHORTEST:
        raise fields.error(
            "step_time", f"{swing:g} s are left for the swing, at least {_SHORTEST} expected"
        )
    fields.done()
    return walk


def _read_foot(fields: Fields) -> Foot:
    foot = Foot(fields.text("task"), fields.text("contact"), fields.vector("pose", 7))
    fields.done()
    return foot
