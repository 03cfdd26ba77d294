"""Part of the controller node: receives previews of the constraint generators.

Subscribes constraints/preview (ghc_msgs/ConstraintPreviews): one message per generator and tick.
"""

from __future__ import annotations

from collections.abc import Callable

from ghc_msgs.msg import ConstraintPreview, ConstraintPreviews

from ghc_controller.controller import Controller
from ghc_controller.errors import GhcError, InvalidValue, UnknownName
from ghc_controller.previews.preview import Preview, StaleRule
from ghc_controller.ros.conversions.previews import preview_from_message
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.types import NANOSECONDS

PREVIEW_TOPIC = "constraints/preview"
SILENCE = 0.1  # [s] of the robot's time; a generator plans every 10 ms
_WAITING = 3  # previews kept per kind and epoch; more only queue up if ticks are ahead of time
_EPOCHS = 3  # of which previews are kept: that of the states, and the newest others

_AFTER = {  # bounds after the end of a preview
    StaleRule.OF_ROBOT: "as robot.yaml says",
    StaleRule.HOLD: "its last point holds",
    StaleRule.RELEASE: "robot.yaml alone holds",
    StaleRule.TIGHTEN: "its tightest point holds",
}

_Waiting = tuple[int, int, ConstraintPreview]  # epoch, start [ns], preview


class PreviewInbox:
    """Keeps previews of each kind until a state at or after their start is answered.

    A malformed preview is rejected as a whole, and the previous one stays active. Rows that the
    robot does not have are ignored. One generator plans for a kind: another one is rejected until
    the first has timed out.
    """

    def __init__(
        self,
        controller: Controller,
        received: Callable[[str, int, int], None],
        reject: Callable[[str, str], object],
    ) -> None:
        """Hand previews to `controller`.

        Args:
            received: called with the kind of a preview, its stamp [ns] and its epoch.
            reject: called with the field and the reason of a rejection or of ignored rows.
        """
        self._controller = controller
        self._received = received
        self._reject = reject
        self._waiting: dict[str, list[_Waiting]] = {}
        self._followed: dict[str, Preview] = {}  # kind -> active preview
        self._epoch: int | None = None  # of the last state

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
            waiting = [*self._waiting.get(kind, []), (message.epoch, start_ns, preview)]
            own, others = self._by_generator(kind, waiting)
            self._waiting[kind] = self._newest(others) + self._newest(own)
            self._received(kind, start_ns, message.epoch)

    def hand_over(self, epoch: int, now_ns: int) -> None:
        """Let the controller follow the newest previews of this epoch that have started at
        `now_ns`."""
        self._epoch = epoch
        for kind, waiting in self._waiting.items():
            if not waiting:
                continue
            begun = [entry for entry in waiting if entry[0] == epoch and entry[1] <= now_ns]
            self._waiting[kind] = [entry for entry in waiting if entry[:2] > (epoch, now_ns)]
            # The newest preview of the current generator is tried last.
            own, others = self._by_generator(kind, begun)
            for _, start_ns, message in others[-1:] + own[-1:]:
                try:
                    self._follow(message, start_ns / NANOSECONDS, now_ns / NANOSECONDS)
                except GhcError as error:
                    self._reject(f"{PREVIEW_TOPIC}/{kind}", str(error))
                except Exception as error:  # of a constraint of another package
                    words = f"preview rejected, {type(error).__name__}: {error}"
                    self._reject(f"{PREVIEW_TOPIC}/{kind}", words)

    def forget(self) -> None:
        """Time restarts: discard all previews."""
        self._followed.clear()

    def silent(self, now: float) -> str:
        """Generators that have timed out at `now` [s], and the rule that applies."""
        complaints = []
        for kind, preview in self._followed.items():
            age = now - preview.start
            if age > SILENCE:
                ended = now > preview.valid_until
                what = f"it has ended: {_AFTER[preview.stale]}" if ended else "following it"
                complaints.append(f"{PREVIEW_TOPIC}/{kind}: last one {age:.2f} s old, {what}")
        return "; ".join(complaints)

    def _by_generator(
        self, kind: str, previews: list[_Waiting]
    ) -> tuple[list[_Waiting], list[_Waiting]]:
        """Splits previews into those of the generator in charge of a kind, and others."""
        before = self._followed.get(kind)
        if before is None:
            return previews, []
        own = [entry for entry in previews if entry[2].name == before.name]
        return own, [entry for entry in previews if entry[2].name != before.name]

    def _newest(self, previews: list[_Waiting]) -> list[_Waiting]:
        """The last few of each epoch, so that those of a wrong one displace no other."""
        arrived = [entry[0] for entry in reversed(previews)]
        known = [] if self._epoch is None else [self._epoch]
        epochs = list(dict.fromkeys([*known, *arrived]))[:_EPOCHS]
        kept: list[_Waiting] = []
        for epoch in epochs:
            kept = [entry for entry in previews if entry[0] == epoch][-_WAITING:] + kept
        return kept

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
            # A separate field: it occurs with every preview and must not hide other rejections.
            field = f"{PREVIEW_TOPIC}/{preview.kind}.left_out"
            self._reject(field, "; ".join(map(str, left_out)))
