"""Interface of constraints that follow previews of one kind."""

from __future__ import annotations

from typing import Protocol

from ghc_controller.errors import UnknownName
from ghc_controller.previews.preview import Preview


class Follower(Protocol):
    """A constraint with bounds that a generator may plan."""

    kind: str  # of the previews

    def follow(self, preview: Preview, now: float | None = None, /) -> tuple[UnknownName, ...]:
        """Use a preview from now on; see `Controller.follow`."""
