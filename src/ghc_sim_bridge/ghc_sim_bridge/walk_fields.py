"""The section `walk` of a scenario file."""

from __future__ import annotations

from ghc_sim_bridge.walk import Foot, Walk
from ghc_sim_bridge.yaml_fields import Fields

_SHORTEST = 0.05  # [s] of a swing


def read_walk(fields: Fields) -> Walk:
    """The walk of a scenario.

    Raises ConfigurationError (file, field, what was given).
    """
    feet = tuple(_read_foot(item) for item in fields.items("feet"))
    if len(feet) != 2:
        raise fields.error("feet", f"2 feet are expected, {len(feet)} given")
    steps = fields.number("steps", minimum=1.0)
    if steps != int(steps):
        raise fields.error("steps", f"a whole number is expected, {steps:g} given")
    walk = Walk(
        task=fields.text("task"),
        center_of_mass=_vector(fields, "center_of_mass", 3),
        feet=(feet[0], feet[1]),
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
        raise fields.error("center_of_mass", f"a height above 0 is expected, {given:g} given")
    swing = walk.step_time - walk.double_support - walk.settle
    if swing < _SHORTEST:
        raise fields.error(
            "step_time", f"{swing:g} s are left for the swing, at least {_SHORTEST} are expected"
        )
    fields.close()
    return walk


def _read_foot(fields: Fields) -> Foot:
    foot = Foot(fields.text("task"), fields.text("contact"), _vector(fields, "pose", 7))
    fields.close()
    return foot


def _vector(fields: Fields, name: str, size: int) -> tuple[float, ...]:
    vector = fields.vector(name)
    if len(vector) != size:
        raise fields.error(name, f"{size} numbers are expected, {len(vector)} given")
    return vector
