"""The part of the controller node that listens to the constraint generators.

Subscribes constraints/preview (ghc_msgs/ConstraintPreviews): one message of each generator a tick.
"""

from __future__ import annotations

from collections.abc import Callable

from ghc_msgs.msg import ConstraintPreview, ConstraintPreviews

from ghc_controller.controller import Controller
from ghc_controller.errors import GhcError, InvalidValue, UnknownName
from ghc_controller.previews.preview import Preview
from ghc_controller.ros.conversions.previews import preview_from_message
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.types import NANOSECONDS

PREVIEW_TOPIC = "constraints/preview"
SILENCE = 0.1  # [s] of the robot's time; a generator plans every 10 ms
_WAITING = 3  # previews of one kind that are kept; more only wait where ticks are ahead of time

_Waiting = tuple[int, int, ConstraintPreview]  # epoch, start [ns], preview


class PreviewInbox:
    """Keeps previews of each kind until a state at or after their start is answered.

    A malformed preview is rejected as a whole, and the one before stays in force. Of a preview
    for rows of which the robot lacks some, those are left out and the rest is followed. One
    generator plans for a kind: another one is rejected until the first has been silent.
    """

    def __init__(
        self,
        controller: Controller,
        received: Callable[[str, int, int], None],
        reject: Callable[[str, str], object],
    ) -> None:
        """Hand previews to `controller`.

        Args:
            received: told the kind of a preview, its stamp [ns] and its epoch.
            reject: told the field and the reason of a rejection, or of what is left out.
        """
        self._controller = controller
        self._received = received
        self._reject = reject
        self._waiting: dict[str, list[_Waiting]] = {}
        self._followed: dict[str, Preview] = {}  # kind -> preview in force

    def take(self, message: ConstraintPreviews) -> None:
        """Keep a message for the next state."""
        start_ns = nanoseconds_from_time(message.header.stamp)
        for preview in message.previews:
            kind = str(preview.kind)
            if kind not in self._controller.preview_kinds:
                unknown = UnknownName("kind of preview", kind, self._controller.preview_kinds)
                self._reject(PREVIEW_TOPIC, str(unknown))
                continue
            # Generators plan ahead: one may wait for its start and the next for a new epoch.
            before = self._waiting.get(kind, [])[1 - _WAITING :]
            self._waiting[kind] = [*before, (message.epoch, start_ns, preview)]
            self._received(kind, start_ns, message.epoch)

    def hand_over(self, epoch: int, now_ns: int) -> None:
        """Let the controller follow the newest previews of this epoch begun at `now_ns`."""
        for kind, waiting in self._waiting.items():
            if not waiting:
                continue
            begun = [entry for entry in waiting if entry[0] == epoch and entry[1] <= now_ns]
            self._waiting[kind] = [entry for entry in waiting if entry[:2] > (epoch, now_ns)]
            if not begun:
                continue
            _, start_ns, message = begun[-1]
            try:
                self._follow(message, start_ns / NANOSECONDS, now_ns / NANOSECONDS)
            except GhcError as error:
                self._reject(f"{PREVIEW_TOPIC}/{kind}", str(error))

    def forget(self) -> None:
        """Time starts again: no preview is in force."""
        self._followed.clear()

    def silent(self, now: float) -> str:
        """Which generators have not been heard for a while at `now` [s], and what holds then."""
        complaints = []
        for kind, preview in self._followed.items():
            age = now - preview.start
            if age > SILENCE:
                ended = now > preview.valid_until
                what = "it has ended: bounds held" if ended else "following it"
                complaints.append(f"{PREVIEW_TOPIC}/{kind}: last one {age:.2f} s old, {what}")
        return "; ".join(complaints)

    def _follow(self, message: ConstraintPreview, start: float, now: float) -> None:
        preview = preview_from_message(message, start)
        before = self._followed.get(preview.kind)
        if before and before.name != preview.name and now - before.start <= SILENCE:
            raise InvalidValue(
                f"generator '{preview.name}' given, while '{before.name}' plans for this kind"
            )
        left_out = self._controller.follow(preview, now)
        self._followed[preview.kind] = preview
        if left_out:
            # A field of its own: it comes with every preview and must not hide other rejections.
            field = f"{PREVIEW_TOPIC}/{preview.kind}.left_out"
            self._reject(field, "; ".join(map(str, left_out)))
