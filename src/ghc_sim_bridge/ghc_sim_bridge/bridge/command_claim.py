"""One commander at a time: who commands the robot, until it falls silent."""

from __future__ import annotations

CLAIM_TIME = 0.5  # [s] wall; so long a commander has to be silent before another one is heard


class CommandClaim:
    """The first sender of a usable command is followed; others are ignored while it is heard.

    Senders are told apart by the name in `frame_id`; those without a name count as one.
    """

    def __init__(self) -> None:
        """Nobody commands yet."""
        self.sender: str | None = None
        self._heard_at = 0.0  # [s] wall

    def blocks(self, sender: str, now: float) -> bool:
        """Whether somebody else commands the robot at `now` [s]."""
        if self.sender is None or sender == self.sender:
            return False
        return now - self._heard_at < CLAIM_TIME

    def takes_over(self, sender: str) -> bool:
        """Whether a command of `sender`, if it is used, ends the claim of another one."""
        return self.sender is not None and sender != self.sender

    def heard(self, sender: str, now: float, used: bool) -> None:
        """Note a command that was not blocked; one that was `used` makes its sender commander."""
        if used or sender == self.sender:
            self.sender, self._heard_at = sender, now
