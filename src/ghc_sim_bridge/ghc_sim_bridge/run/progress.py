"""Progress of a run: a bar on a terminal, otherwise one line per phase."""

from __future__ import annotations

import sys
import time
from typing import Self

from tqdm import tqdm

_BAR = "{desc} |{bar:24}| {n:6.2f} / {total:.2f} s simulated, {postfix}"


class Progress:
    """Shows simulated time, real time factor and the current hierarchy."""

    def __init__(self, title: str, duration: float) -> None:
        """`duration` [s] is the simulated length of the run."""
        self._title = title
        self._began = time.monotonic()
        self._shown = ""
        self._duration = duration
        self._bar: tqdm | None = None
        if sys.stderr.isatty():
            self._bar = tqdm(total=duration, bar_format=_BAR, leave=False)
            self._bar.set_description_str(title)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()

    def update(self, simulated: float, hierarchy: str) -> None:
        """Show the simulated time [s] and the current hierarchy."""
        factor = simulated / max(time.monotonic() - self._began, 1e-9)
        if self._bar is not None:
            self._bar.n = min(simulated, self._duration)
            self._bar.set_postfix_str(f"{factor:.2f} x real time, {hierarchy}", refresh=False)
            self._bar.refresh()
        elif hierarchy != self._shown:
            self._shown = hierarchy
            line = f"{self._title}: {simulated:7.2f} s simulated ({factor:.2f} x real time)"
            print(f"{line}: {hierarchy}", file=sys.stderr, flush=True)
