"""Network conditions: delay and loss of each frame."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from random import Random


@dataclass(frozen=True, slots=True)
class Conditions:
    """The same for every pair of hosts and both directions."""

    delay: float = 0.0  # [s]
    jitter: float = 0.0  # [s] the delay is uniform within delay +- jitter, so frames overtake
    loss: float = 0.0  # [-] share of frames that are lost, each by itself
    cut: bool = False  # nothing gets through

    def lag(self, random: Random) -> float | None:
        """Delay of a frame [s]; None: it is lost."""
        if self.cut or random.random() < self.loss:
            return None
        return max(self.delay + random.uniform(-self.jitter, self.jitter), 0.0)

    def line(self) -> str:
        """As a line of text."""
        return json.dumps(asdict(self))

    @classmethod
    def of_line(cls, text: str) -> Conditions:
        """Back from a line."""
        return cls(**json.loads(text))
