"""The doubles of ros2_control do what the upstream lines say that they do."""

from __future__ import annotations

import math

import pytest
from ros2_control_doubles import (
    EffortInterfaces,
    JointGroupEffortController,
    JointStateBroadcaster,
)

JOINTS = ("a", "b", "c")


@pytest.fixture
def interfaces() -> EffortInterfaces:
    return EffortInterfaces(JOINTS)


def running(interfaces: EffortInterfaces) -> JointGroupEffortController:
    """An active controller whose parameter names the joints in another order."""
    controller = JointGroupEffortController(("c", "a", "b"), interfaces)
    assert controller.activate()
    return controller


def test_nothing_is_commanded_before_the_first_message(interfaces: EffortInterfaces) -> None:
    running(interfaces).update()
    assert all(map(math.isnan, interfaces.values.values()))
    assert not interfaces.complete


def test_entries_go_to_the_joints_of_the_parameter(interfaces: EffortInterfaces) -> None:
    controller = running(interfaces)
    controller.on_command([1.0, 2.0, 3.0])
    controller.update()
    assert interfaces.values == {"c": 1.0, "a": 2.0, "b": 3.0}
    assert interfaces.complete


def test_the_last_command_is_written_in_every_cycle(interfaces: EffortInterfaces) -> None:
    controller = running(interfaces)
    controller.on_command([1.0, 2.0, 3.0])
    for _ in range(1000):
        interfaces.values["a"] = 0.0
        controller.update()
        assert interfaces.values["a"] == 2.0


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_drops_the_message(
    interfaces: EffortInterfaces, bad: float
) -> None:
    controller = running(interfaces)
    controller.on_command([1.0, 2.0, 3.0])
    controller.on_command([4.0, bad, 6.0])
    controller.update()
    assert interfaces.values == {"c": 1.0, "a": 2.0, "b": 3.0}
    assert controller.dropped == 1


@pytest.mark.parametrize("size", [0, 2, 4])
def test_a_wrong_size_ends_the_controller_with_zero_torque(
    interfaces: EffortInterfaces, size: int
) -> None:
    controller = running(interfaces)
    controller.on_command([1.0, 2.0, 3.0])
    controller.update()
    controller.on_command([5.0] * size)
    controller.update()
    assert (controller.wrong_size, controller.active) == (1, False)
    assert set(interfaces.values.values()) == {0.0}
    controller.on_command([1.0, 2.0, 3.0])
    controller.update()
    assert set(interfaces.values.values()) == {0.0}


def test_activation_forgets_what_came_before(interfaces: EffortInterfaces) -> None:
    controller = JointGroupEffortController(JOINTS, interfaces)
    controller.on_command([1.0, 2.0, 3.0])
    assert controller.activate()
    controller.update()
    assert not interfaces.complete


def test_an_unknown_joint_is_not_activated(interfaces: EffortInterfaces) -> None:
    assert not JointGroupEffortController(("a", "elbow"), interfaces).activate()


def test_the_broadcaster_stamps_and_fills_what_is_missing_with_nan() -> None:
    names = [f"joint_{i}" for i in range(1, 8)]
    broadcaster = JointStateBroadcaster(names)
    values = {name: {"position": float(i), "velocity": 0.5} for i, name in enumerate(names)}
    message = broadcaster.message(3_000_000_007, values)
    assert list(message.name) != names
    assert sorted(message.name) == names
    assert list(message.position) == [float(names.index(name)) for name in message.name]
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (3, 7)
    assert message.header.frame_id == ""
    assert len(message.effort) == 7
    assert all(map(math.isnan, message.effort))
