"""The ratio of control period and physics step, validated on construction."""

from __future__ import annotations

from ghc_controller.errors import InvalidValue

PHYSICS_DT = 1e-3  # [s] step of the integrator where nothing else is said, and the longest one

RATIO_TOLERANCE = 1e-6  # relative; more than rounding of decimal fractions, less than any mistake


def count_substeps(control_dt: float, physics_dt: float) -> int:
    """How many physics steps make one control period.

    Raises InvalidValue, with both numbers, when a period is not positive or the control period
    is not a whole multiple of the physics step.
    """
    if not (control_dt > 0.0 and physics_dt > 0.0):
        raise InvalidValue(
            f"control_dt = {control_dt:g} s and physics_dt = {physics_dt:g} s must be positive"
        )
    ratio = control_dt / physics_dt
    substeps = round(ratio)
    if substeps < 1 or abs(ratio - substeps) > RATIO_TOLERANCE * ratio:
        raise InvalidValue(
            f"control_dt = {control_dt:g} s is not a whole multiple of "
            f"physics_dt = {physics_dt:g} s (ratio {ratio:.6g})"
        )
    return substeps
