"""One consumer of external input, with its documented errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any

from hypothesis import strategies as st

from benchmarks.fuzz.edits import edited as edited_case
from ghc_controller import GhcError

MESSAGE_BUDGET = 0.010  # [s] of CPU, for whatever comes while the robot moves
FILE_BUDGET = 0.010  # [s] of CPU, for files, which are read before a node is ready


@dataclass(frozen=True, slots=True)
class Target:
    """A fuzz target: `run` raises one of `documented`, or nothing."""

    name: str
    cases: st.SearchStrategy[Any]
    run: Callable[[Any], object]
    documented: tuple[type[Exception], ...] = (GhcError,)
    budget: float = MESSAGE_BUDGET  # [s] of CPU per case
    share: float = 1.0  # [-] of the cases of one target; files are slow
    edit: Callable[[Any, Random], Any] = edited_case  # another case of one, maybe in place


ANY_FLOAT = st.floats(width=64)
ODD_FLOAT = st.one_of(
    st.floats(-10.0, 10.0),
    ANY_FLOAT,
    st.sampled_from([0.0, -0.0, 1.0, 0.5, 1e-300, 1e300, float("nan"), float("inf")]),
)
STAMP = st.tuples(
    st.one_of(st.integers(0, 100), st.integers(-(2**31), 2**31 - 1)),
    st.one_of(st.integers(0, 10**9 - 1), st.integers(0, 2**32 - 1)),
)
WORD = st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=12)


@st.composite
def mutated(draw: st.DrawFn, originals: tuple[bytes, ...]) -> bytes:
    """Bytes of a sound message with some changed, cut off, doubled or put in."""
    data = bytearray(draw(st.sampled_from(originals)))
    for _ in range(draw(st.integers(0, 4))):
        at = draw(st.integers(0, max(len(data) - 1, 0)))
        how = draw(st.integers(0, 4))
        if how == 0 and data:
            data[at] = draw(st.integers(0, 255))
        elif how == 1:
            del data[at:]
        elif how == 2:
            data[at:at] = draw(st.binary(max_size=16))
        elif how == 3:
            data[at : at + 4] = draw(
                st.sampled_from([b"\xff" * 4, b"\0" * 4, b"\xff\xff\xff\x7f"])
            )
        else:
            data[at:at] = data[at : at + draw(st.integers(0, 64))]
    return bytes(data)


@st.composite
def edited(draw: st.DrawFn, originals: tuple[str, ...], words: tuple[str, ...]) -> str:
    """Text of a sound file with values, lines or characters exchanged."""
    lines = draw(st.sampled_from(originals)).split("\n")
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(lines) - 1))
        how = draw(st.integers(0, 4))
        word = draw(st.one_of(st.sampled_from(words), WORD))
        if how == 0:
            lines[at] = ""
        elif how == 1:
            lines.insert(at, lines[draw(st.integers(0, len(lines) - 1))])
        elif how == 2:
            pieces = lines[at].split(" ")
            pieces[draw(st.integers(0, len(pieces) - 1))] = word
            lines[at] = " ".join(pieces)
        elif how == 3:
            cut = draw(st.integers(0, len(lines[at])))
            lines[at] = lines[at][:cut] + word + lines[at][cut:]
        else:
            lines[at] = word
    return "\n".join(lines)
