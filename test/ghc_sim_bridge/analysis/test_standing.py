"""Figures of balance on motions and loads that are made up here."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ghc_sim_bridge.analysis.standing import base_motion, base_tilt, torque_use
from ghc_sim_bridge.logs.contact_loads import ContactSurface, LoadTrace
from ghc_sim_bridge.logs.full_rate_log import FullRateLog

DT = 0.01
UP = ContactSurface(np.array([0.0, 0.0, 1.0]), 0.5)


def turned(axis: list[float], degrees: float) -> np.ndarray:
    """Quaternion xyzw."""
    half = np.radians(degrees) / 2.0
    return np.append(np.sin(half) * np.array(axis), np.cos(half))


def poses(heights: list[float], tilts: list[float]) -> np.ndarray:
    return np.array(
        [[0.0, 0.0, h, *turned([0.6, 0.8, 0.0], t)] for h, t in zip(heights, tilts, strict=True)]
    )


def log_with(wrench: np.ndarray) -> FullRateLog:
    rows = len(wrench)
    nothing = np.zeros((rows, 1))
    return FullRateLog(
        np.arange(rows) * DT,
        *(nothing,) * 5,
        np.zeros(rows, np.uint8),
        np.zeros(rows, np.uint32),
        np.full(rows, DT),
        {"sole": wrench},
        ("knee",),
        DT,
    )


@pytest.mark.parametrize("angle", [0.0, 1e-4, 7.0, 90.0, 135.0, 180.0])
def test_tilt_is_the_angle_to_the_vertical_at_any_heading(angle: float) -> None:
    tilted = np.append(np.zeros(3), turned([0.6, -0.8, 0.0], angle))
    assert base_tilt(tilted[None]) == pytest.approx(angle, abs=1e-6)
    heading = np.append(np.zeros(3), turned([0.0, 0.0, 1.0], angle))
    assert base_tilt(heading[None]) == pytest.approx(0.0, abs=1e-6)


def test_standing_is_judged_by_height_and_tilt_at_the_end() -> None:
    motion = base_motion(poses([0.6, 0.3, 0.57], [0.0, 30.0, 4.0]))
    assert motion.stands()
    assert motion.height_lowest == 0.3 and motion.tilt_largest == pytest.approx(30.0)
    assert not base_motion(poses([0.6, 0.5], [0.0, 0.0])).stands()
    assert not base_motion(poses([0.6, 0.7], [0.0, 0.0])).stands()
    assert not base_motion(poses([0.6, 0.6], [0.0, 11.0])).stands()
    risen = base_motion(poses([0.3, 0.58], [0.0, 0.0]))
    assert risen.stands(0.6) and not risen.stands()


def test_torque_use_is_that_of_the_joint_nearest_its_limit() -> None:
    torque = np.array([[1.0, -9.0, 5.0], [-3.0, 2.0, 6.0]])
    use, joint = torque_use(torque, np.array([4.0, 30.0, np.inf]), ("a", "b", "c"))
    assert (use, joint) == (0.75, "a")


def _report(forces: dict[str, float], use: float) -> Any:
    """What is read of a ControllerState with these contacts on, and one that is off."""
    contacts = [
        SimpleNamespace(name=name, on=True, force=force, friction_use=use)
        for name, force in forces.items()
    ]
    contacts.append(SimpleNamespace(name="off", on=False, force=0.0, friction_use=0.0))
    return SimpleNamespace(contacts=contacts)


def test_loads_are_compared_with_what_is_sensed_a_period_later() -> None:
    rng = np.random.default_rng(4)
    asked = rng.uniform(20.0, 40.0, 50)
    wrench = np.zeros((51, 6))
    wrench[1:, 2] = asked + 0.5
    wrench[1:, 1] = 0.25 * wrench[1:, 2]  # half of what friction allows
    trace = LoadTrace()
    for k, force in enumerate(asked):
        trace.append(
            k * DT,
            _report({"sole": force}, 0.3),
        )
    figures = trace.figures(log_with(wrench), {"sole": UP})["sole"]
    assert figures.difference_rms_n == pytest.approx(0.5)
    assert figures.difference_largest_n == pytest.approx(0.5)
    assert figures.asked_n == (asked.min(), asked.max())
    assert figures.friction_use_simulated == pytest.approx(0.5)
    assert figures.friction_use_qp == 0.3 and figures.share_of_time_on == 1.0


def test_a_contact_counts_while_it_is_on() -> None:
    """Off half of the time; one without a sensor is left out."""
    trace = LoadTrace()
    for k in range(10):
        names = ["sole", "unseen"] if k < 5 else []
        trace.append(
            k * DT,
            _report(dict.fromkeys(names, 10.0), 0.0),
        )
    wrench = np.zeros((10, 6))
    wrench[:6, 2] = 10.0
    figures = trace.figures(log_with(wrench), {"sole": UP, "unseen": UP})
    assert set(figures) == {"sole"}
    assert figures["sole"].share_of_time_on == 0.5
    assert figures["sole"].difference_largest_n == 0.0
