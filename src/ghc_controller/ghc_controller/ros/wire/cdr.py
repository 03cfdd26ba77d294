"""Reads and writes serialized messages in place; the constant part is laid out once.

Plain CDR in native byte order. Alignment is relative to the end of the four-byte encapsulation
header, and every message here begins with a stamp.
"""

from __future__ import annotations

import struct
import sys

import numpy as np

from ghc_controller.types import NANOSECONDS, Array

ENCAPSULATION_SIZE = 4  # [bytes]
STAMP_END = ENCAPSULATION_SIZE + 8  # [bytes] sec (int32) and nanosec (uint32) stand before it
BYTE_ORDER = b"\x00\x01" if sys.byteorder == "little" else b"\x00\x00"
ENCAPSULATION = BYTE_ORDER + b"\x00\x00"  # the options after the byte order are unused here

_STAMP = struct.Struct("=iI")
_LENGTH = struct.Struct("=I")
_TICK = struct.Struct("=iIQ")


def read_stamp(data: bytes | bytearray) -> int:
    """Stamp [ns] of a serialized message that begins with one.

    Raises:
        ValueError: the message is shorter than that.
    """
    if len(data) < STAMP_END:
        raise ValueError(f"{len(data)} bytes are too few for a stamp")
    seconds, nanoseconds = _STAMP.unpack_from(data, ENCAPSULATION_SIZE)
    return int(seconds) * NANOSECONDS + int(nanoseconds)


def write_stamp(buffer: bytearray, stamp_ns: int) -> None:
    """Put `stamp_ns` [ns] into a serialized message that begins with a stamp."""
    _STAMP.pack_into(buffer, ENCAPSULATION_SIZE, *divmod(stamp_ns, NANOSECONDS))


def number_view(data: bytes | bytearray, count: int, start: int) -> Array:
    """View of `count` float64 at offset `start` [bytes]; writable if `data` is."""
    return np.frombuffer(data, np.float64, count, start) if count else np.empty(0)


def numbers_behind_strings(data: bytes, strings: int, count: int) -> Array:
    """The first `count` float64 of a message that begins with a stamp and `strings` strings.

    Raises:
        ValueError: the message is shorter than that, or in another byte order.
    """
    if not data.startswith(BYTE_ORDER):
        raise ValueError(f"encapsulation {data[:2].hex()} given, {BYTE_ORDER.hex()} expected")
    end = STAMP_END
    try:
        for _ in range(strings):
            begin = end + -end % 4
            end = begin + 4 + _LENGTH.unpack_from(data, begin)[0]
    except struct.error as error:
        raise ValueError(f"{len(data)} bytes are too few: {error}") from error
    return number_view(data, count, end + (ENCAPSULATION_SIZE - end) % 8)


class CdrBody:
    """Bytes of a message after its encapsulation, with zeros as placeholders for numbers."""

    def __init__(self) -> None:
        """Begin with space for a stamp."""
        self._body = bytearray(STAMP_END - ENCAPSULATION_SIZE)
        self._pieces: list[tuple[int, int]] = []  # [bytes] begin and end of the written ranges

    def append_length(self, length: int) -> None:
        """Add the length of the sequence that follows."""
        self._align(4)
        self._write(_LENGTH.pack(length))

    def append_string(self, text: str) -> None:
        """Add a string with its length and closing zero."""
        encoded = text.encode() + b"\x00"
        self.append_length(len(encoded))
        self._write(encoded)

    def append_numbers(self, count: int) -> int:
        """Add space for `count` float64; returns its offset [bytes] in the whole message."""
        if count:
            self._align(8)
        start = len(self._body) + ENCAPSULATION_SIZE
        self._body.extend(bytes(8 * count))
        return start

    def _align(self, size: int) -> None:
        self._body.extend(bytes(-len(self._body) % size))

    def _write(self, data: bytes) -> None:
        start = len(self._body)
        self._body.extend(data)
        if self._pieces and self._pieces[-1][1] == start:
            start = self._pieces.pop()[0]
        self._pieces.append((start, len(self._body)))

    def message(self) -> bytearray:
        """The whole message."""
        return bytearray(ENCAPSULATION) + self._body

    def fixed_pieces(self) -> tuple[tuple[int, bytes], ...]:
        """(begin, bytes) of all but stamp, numbers and padding; padding is undefined."""
        return ((0, BYTE_ORDER),) + tuple(
            (start + ENCAPSULATION_SIZE, bytes(self._body[start:end]))
            for start, end in self._pieces
        )


def encode_tick(start_ns: int, epoch: int) -> bytes:
    """Serialized ghc_msgs/Tick that starts at `start_ns` [ns]."""
    return ENCAPSULATION + _TICK.pack(*divmod(start_ns, NANOSECONDS), epoch)


def decode_tick(data: bytes) -> tuple[int, int]:
    """Start [ns] and epoch of a serialized ghc_msgs/Tick.

    Raises:
        ValueError: the bytes are not a Tick.
    """
    order = "<" if data[1:2] == b"\x01" else ">"
    try:
        seconds, nanoseconds, epoch = struct.unpack_from(order + "iIQ", data, ENCAPSULATION_SIZE)
    except struct.error as error:
        raise ValueError(f"no Tick: {error}") from error
    return seconds * NANOSECONDS + nanoseconds, epoch
