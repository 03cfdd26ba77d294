"""Diagnostics of a generator node, once per second."""

from __future__ import annotations

from collections.abc import Mapping

from diagnostic_msgs.msg import DiagnosticArray

from ghc_controller.ros.conversions.common import diagnostics_message
from ghc_controller.ros.rejections import Recent, Rejections
from ghc_mpc_constraints.generator import Generator
from ghc_mpc_constraints.ros.inputs import Input


class GeneratorDiagnostics:
    """Counts of generator, input and rejections, and the longest tick since the last report."""

    def __init__(
        self,
        name: str,
        generator: Generator,
        given: Input,
        rejections: Rejections,
        smoothing: bool,
    ) -> None:
        """Report under the `name` of the generator."""
        self._name = name
        self._generator, self._input = generator, given
        self._rejections = rejections
        self._smoothing = smoothing
        self._recent = Recent()
        self._longest = 0.0  # [s] wall

    def ticked(self, seconds: float) -> None:
        """Register the wall time of a tick."""
        self._longest = max(self._longest, seconds)

    def report(self, now_ns: int) -> DiagnosticArray:
        """The message at the newest stamp `now_ns` [ns]; -1 before the first tick."""
        generator = self._generator
        trouble = sum(generator.counts[name] for name in generator.TROUBLE)
        counts: Mapping[str, int] = {
            **generator.counts,
            "second_opinions": generator.second_opinions,
            **self._input.counts,
        }
        rejected = self._rejections.counts
        refused = sum(rejected.values())
        warning, summary = self._recent.told(
            trouble + refused,
            f"{trouble} plans without a solution or inputs in doubt, {refused} rejected",
            "ok" if now_ns >= 0 else "waiting for ghc/tick",
        )
        values: dict[str, object] = {
            "longest_tick_ms": round(1e3 * self._longest, 3),
            "smoothing": self._smoothing,
            **counts,
            **{f"rejected_{name}": count for name, count in sorted(rejected.items())},
        }
        self._longest = 0.0
        return diagnostics_message(max(now_ns, 0), self._name, summary, warning, values)
