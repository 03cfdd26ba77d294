"""Random edits of a case: a few of its values are replaced by others of the same type.

A case that hypothesis draws costs milliseconds, one that is made of it by an edit microseconds.
"""

from __future__ import annotations

import math
import struct
from array import array
from random import Random
from typing import Any

import numpy as np

ODD = (0.0, -0.0, 1.0, -1.0, 0.5, 1e-300, 1e300, math.nan, math.inf, -math.inf)
WHOLE = (0, 1, -1, 2**31 - 1, 2**32 - 1, 2**62, -(2**31))
WORDS = (
    "",
    ">",
    "=",
    " > ",
    "\n",
    ": ",
    "- ",
    "[",
    "{",
    "nan",
    "1e400",
    "-1",
    "é",
    "\x7f",
    "x" * 99,
)
LONGEST = 64  # [-] bytes or characters that one edit doubles


def edited(value: Any, random: Random) -> Any:
    """The value with one edit; arrays and messages are changed in place."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return random.choice((*WHOLE, value + 1, value - 1, random.getrandbits(20)))
    if isinstance(value, float):
        return odd_number(random)
    if isinstance(value, bytes):
        return _spliced(value, random, random.randbytes(random.randrange(9)))
    if isinstance(value, str):
        return _spliced(value, random, random.choice(WORDS))
    if isinstance(value, tuple):
        parts = list(value)
        if parts:
            at = random.randrange(len(parts))
            parts[at] = edited(parts[at], random)
        return tuple(parts)
    if isinstance(value, np.ndarray):  # of a fixed size
        value[random.randrange(len(value))] = odd_number(random)
        return value
    if isinstance(value, list | array):
        return _of_list(value, random)
    return _of_message(value, random)


def odd_number(random: Random) -> float:
    """A number that is odd, of any size, or plain."""
    kind = random.randrange(4)
    if kind == 0:
        return random.choice(ODD)
    if kind == 1:
        (number,) = struct.unpack("<d", random.randbytes(8))
        return float(number)
    return random.uniform(-2.0, 2.0)


def _spliced(value: Any, random: Random, piece: Any) -> Any:
    """Bytes or characters put in, cut out, doubled or exchanged."""
    at, how = random.randrange(len(value) + 1), random.randrange(5)
    end = at + random.randrange(LONGEST)
    if how == 0:
        return value[:at]
    if how == 1:
        return value[:at] + value[end:]
    if how == 2:
        return value[:at] + value[at:end] + value[at:]
    if how == 3:
        return value[:at] + piece + value[at:]
    return value[:at] + piece + value[at + len(piece) :]


def _of_list(value: Any, random: Random) -> Any:
    """An entry more, less, doubled or edited."""
    how = random.randrange(5)
    if not len(value):
        return value
    at = random.randrange(len(value))
    if how == 0:
        del value[at]
    elif how == 1:
        value.insert(at, value[at])
    else:
        value[at] = _fitting(value[at], random)
    return value


def _of_message(message: Any, random: Random) -> Any:
    """A field edited; values that its type rejects are not changed."""
    name = random.choice(list(message.get_fields_and_field_types()))
    try:
        setattr(message, name, edited(getattr(message, name), random))
    except (AssertionError, OverflowError, TypeError, ValueError):
        return message
    return message


def _fitting(entry: Any, random: Random) -> Any:
    """An edited entry of a list, whose type does not change."""
    if isinstance(entry, int) and not isinstance(entry, bool):
        return random.choice((0, 1, 2, 255))  # an array of bytes takes no more
    return edited(entry, random)
