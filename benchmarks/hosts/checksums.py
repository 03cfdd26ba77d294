"""`python -m benchmarks.hosts.checksums DEVICE`: disable checksum offloading of a device.

Else it leaves them to a network card that does not exist, and a hub would pass frames on that
every receiver drops. What `ethtool -K DEVICE tx off` does, which is not installed everywhere.
"""

from __future__ import annotations

import array
import fcntl
import socket
import struct
import sys

_SIOCETHTOOL = 0x8946  # of linux/sockios.h
_ETHTOOL_STXCSUM = 0x17  # of linux/ethtool.h


def fill_in(device: str) -> None:
    """Switch the offload of checksums off; OSError where that is not possible."""
    request = array.array("B", struct.pack("II", _ETHTOOL_STXCSUM, 0))
    address, _ = request.buffer_info()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, _SIOCETHTOOL, struct.pack("16sP", device.encode(), address))


if __name__ == "__main__":
    fill_in(sys.argv[1])
