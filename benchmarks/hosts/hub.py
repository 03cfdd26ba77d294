"""A hub between hosts in user space, as a process: for kernels without netem.

`python -m benchmarks.hosts.hub PIPE DEVICE...` copies every Ethernet frame from one device to all
others. A line of `Conditions` on the pipe is in force from then on.
"""

from __future__ import annotations

import heapq
import os
import select
import socket
import sys
import time
from collections.abc import Sequence
from itertools import count
from random import Random

from benchmarks.hosts.conditions import Conditions

_EVERY_PROTOCOL = 3  # ETH_P_ALL of linux/if_ether.h
_LARGEST = 65536  # [bytes] of a frame
_BUFFER = 2**22  # [bytes] of a socket; what does not fit is lost, as in any network


def serve(pipe: str, devices: Sequence[str], seed: int = 0) -> None:
    """Copy frames until the process is killed."""
    random, conditions = Random(seed), Conditions()
    sockets = [_open(device) for device in devices]
    control = os.open(pipe, os.O_RDWR | os.O_NONBLOCK)  # not at its end between two writers
    late: list[tuple[float, int, int, bytes]] = []  # due [s], number, from which device, frame
    numbers = count()
    print("ready", flush=True)
    while True:
        wait = max(late[0][0] - time.monotonic(), 0.0) if late else None
        ready, _, _ = select.select([*sockets, control], [], [], wait)
        if control in ready:
            conditions = Conditions.of_line(os.read(control, _LARGEST).decode().splitlines()[-1])
        for source, given in enumerate(sockets):
            frame = _receive(given) if given in ready else b""
            lag = conditions.lag(random) if frame else None
            if lag is not None:
                due = time.monotonic() + lag
                heapq.heappush(late, (due, next(numbers), source, frame))
        while late and late[0][0] <= time.monotonic():
            _, _, source, frame = heapq.heappop(late)
            for at, other in enumerate(sockets):
                if at != source:
                    _send(other, frame)


def _open(device: str) -> socket.socket:
    made = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(_EVERY_PROTOCOL))
    made.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
    made.bind((device, 0))
    return made


def _receive(given: socket.socket) -> bytes:
    """A frame that a host has sent; empty for those of the hub itself."""
    try:
        frame, address = given.recvfrom(_LARGEST)
    except OSError:  # told once that the host at the other end went away
        return b""
    return b"" if address[2] == socket.PACKET_OUTGOING else frame  # type: ignore[attr-defined]


def _send(to: socket.socket, frame: bytes) -> None:
    try:
        to.send(frame)
    except OSError:  # a full queue, or a frame that the device does not take: lost
        return


if __name__ == "__main__":
    serve(sys.argv[1], sys.argv[2:])
