"""A force bound that steps, and the preview that a generator makes of it.

python examples/force_bounds_preview.py
"""

from __future__ import annotations

from ghc_mpc_constraints import ContactForceBounds, ContactSchedule, ForceBoundSettings

STEP = 0.01  # [s] between two ticks


def main() -> None:
    """Print the raw bound, the current one and what is planned half a second ahead."""
    generator = ContactForceBounds(ForceBoundSettings(step=STEP, horizon=1.5))
    # The foot may carry 60 N, from 1 s on 20 N, and from 2 s on 60 N again.
    schedule = ContactSchedule.checked(
        "foot", times=[0.0, 1.0, 2.0], lower=[0.0, 0.0, 0.0], upper=[60.0, 20.0, 60.0]
    )
    generator.observe(schedule, now=0.0)
    steepest, before = 0.0, 60.0
    for tick in range(301):
        now = tick * STEP
        preview = generator.tick(now)
        raw = schedule.at(now)[1]
        (upper,) = preview.at(now)[1]
        (ahead,) = preview.at(now + 0.5)[1]
        assert upper <= raw + 1e-9
        steepest, before = max(steepest, abs(upper - before) / STEP), upper
        if tick % 50 == 0:
            print(f"t = {now:.1f} s: raw {raw:2.0f} N, active {upper:4.1f} N, then {ahead:4.1f} N")
    print(f"never looser than raw; at most {steepest:.0f} N/s")


if __name__ == "__main__":
    main()
