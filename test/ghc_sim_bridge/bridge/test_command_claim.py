"""One commander is followed until it is silent."""

from __future__ import annotations

from ghc_sim_bridge.bridge.command_claim import CLAIM_TIME, CommandClaim


def test_the_first_one_whose_command_is_used_is_followed() -> None:
    claim = CommandClaim()
    claim.heard("stale", 0.0, used=False)
    assert not claim.blocks("mine", 0.0)
    claim.heard("mine", 0.0, used=True)
    for k in range(100):
        now = 0.01 * k
        assert claim.blocks("other", now)
        assert claim.blocks("", now)
        claim.heard("mine", now, used=False)  # also a repeat keeps the claim
    assert not claim.blocks("mine", now)


def test_after_a_silence_another_one_takes_over() -> None:
    claim = CommandClaim()
    claim.heard("mine", 0.0, used=True)
    assert claim.blocks("next", CLAIM_TIME - 1e-6)
    assert not claim.blocks("next", CLAIM_TIME)
    claim.heard("next", CLAIM_TIME, used=True)
    assert claim.blocks("mine", CLAIM_TIME)


def test_a_takeover_is_a_change_of_the_commander_and_not_the_first_one() -> None:
    claim = CommandClaim()
    assert not claim.takes_over("mine")
    claim.heard("mine", 0.0, used=True)
    assert not claim.takes_over("mine")
    assert claim.takes_over("next")
    assert claim.takes_over("")
