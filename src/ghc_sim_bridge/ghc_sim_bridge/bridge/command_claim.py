"""One commander at a time: it commands the robot until it times out."""

from __future__ import annotations

CLAIM_TIME = 0.5  # [s] wall; timeout after which another commander is accepted


class CommandClaim:
    """The first sender of a valid command is followed; others are ignored until it times out.

    Senders are distinguished by the name in `frame_id`; those without a name count as one.
    """

    def __init__(self) -> None:
        """No commander yet."""
        self.sender: str | None = None
        self._heard_at = 0.0  # [s] wall

    def blocks(self, sender: str, now: float) -> bool:
        """Whether another sender commands the robot at `now` [s]."""
        if self.sender is None or sender == self.sender:
            return False
        return now - self._heard_at < CLAIM_TIME

    def takes_over(self, sender: str) -> bool:
        """Whether a command of `sender`, if it is used, ends the claim of another one."""
        return self.sender is not None and sender != self.sender

    def heard(self, sender: str, now: float, used: bool) -> None:
        """Register a command that was not blocked; if `used`, its sender becomes the commander."""
        if used or sender == self.sender:
            self.sender, self._heard_at = sender, now
