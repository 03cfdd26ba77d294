"""Modes: what leads from one to the other, and what is rejected in each."""

from __future__ import annotations

import pytest

from ghc_controller.safety.modes import Arming, Mode, ModeLogic


def _started(arming: Arming) -> tuple[ModeLogic, list[Mode]]:
    seen: list[Mode] = []
    logic = ModeLogic(arming, lambda: seen.append(logic.mode))
    assert logic.mode is Mode.WAITING
    logic.started()
    return logic, seen


@pytest.mark.parametrize("arming", [Arming.REQUEST, Arming.AUTOMATIC])
def test_the_first_accepted_request_arms(arming: Arming) -> None:
    """Also one that was asked to hold: a request is followed in no other mode than active."""
    logic, seen = _started(arming)
    logic.hold()
    assert seen[-1] is Mode.HOLDING
    assert logic.refusal() == ""
    logic.requested()
    logic.requested()
    assert seen[-2:] == [Mode.HOLDING, Mode.ACTIVE]


def test_explicit_arming_refuses_requests_until_then() -> None:
    logic, seen = _started(Arming.EXPLICIT)
    assert "controller/arm" in logic.refusal()
    logic.requested()
    assert logic.mode is Mode.HOLDING
    assert logic.arm() == ""
    assert logic.refusal() == ""
    assert logic.hold() == ""
    assert seen == [Mode.HOLDING, Mode.ACTIVE, Mode.HOLDING]


@pytest.mark.parametrize("arming", [Arming.REQUEST, Arming.EXPLICIT])
def test_a_fault_is_latched_with_its_first_reason_until_reset(arming: Arming) -> None:
    logic, seen = _started(arming)
    logic.arm()
    logic.fault("first")
    logic.fault("second")
    assert logic.reason.startswith("first; call controller/reset_fault")
    for refused in (logic.arm(), logic.hold(), logic.refusal()):
        assert "first" in refused
    logic.requested()
    logic.started()  # a reset of the bridge does not clear it
    assert logic.mode is Mode.LATCHED
    assert logic.reset_fault() == ""
    assert "no fault" in logic.reset_fault()
    assert seen == [Mode.HOLDING, Mode.ACTIVE, Mode.LATCHED, Mode.HOLDING]


def test_an_automatic_controller_is_active_at_once_and_latches_nothing() -> None:
    logic, seen = _started(Arming.AUTOMATIC)
    logic.fault("anything")
    assert seen == [Mode.ACTIVE]


@pytest.mark.parametrize("arming", Arming)
def test_a_run_that_cannot_begin_waits_and_takes_no_request(arming: Arming) -> None:
    """Also where an earlier run was under way; a change of the reason alone is told as well."""
    logic, seen = _started(arming)
    logic.arm()
    seen.clear()
    for reason in ("joint_1", "joint_1", "joint_2"):
        logic.waits(reason)
        assert reason in logic.refusal()
    assert seen == [Mode.WAITING, Mode.WAITING]
    logic.started()
    assert logic.mode is (Mode.ACTIVE if arming is Arming.AUTOMATIC else Mode.HOLDING)


def test_a_latched_fault_does_not_wait() -> None:
    logic, _ = _started(Arming.REQUEST)
    logic.fault("first")
    logic.waits("joint_1")
    assert logic.mode is Mode.LATCHED
