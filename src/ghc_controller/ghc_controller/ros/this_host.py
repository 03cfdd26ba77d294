"""Closed by default: discovery and data of a process stay on this host.

`ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST` only disables multicast discovery. Sockets stay open on
all interfaces, so that any host that lists this one as a static peer can read and write every
topic, and static peers of this process are still contacted. Here the middleware opens sockets on
the loopback interface only. Call before `rclpy.init`, which reads these variables once.
"""

from __future__ import annotations

import os
from collections.abc import MutableMapping
from pathlib import Path

from ghc_controller.errors import InvalidValue

CHOICE = "GHC_NETWORK"
HOST, NETWORK = "host", "network"
PROFILE = Path(__file__).with_name("this_host.xml")
# Variables that would open the host or select another profile.
_REMOVED = (
    "ROS_STATIC_PEERS",
    "ROS_LOCALHOST_ONLY",
    "ROS_DISCOVERY_SERVER",
    "FASTDDS_BUILTIN_TRANSPORTS",
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "FASTDDS_ENVIRONMENT_FILE",
)


def stay_on_this_host(environment: MutableMapping[str, str] = os.environ) -> None:
    """Close the environment of this process and its children, unless GHC_NETWORK opens it.

    With GHC_NETWORK=network nothing is changed: discovery, peers, profiles and security are then
    those of the environment.

    Raises:
        InvalidValue: GHC_NETWORK is neither `host`, `network` nor empty.
    """
    choice = environment.get(CHOICE) or HOST
    if choice == NETWORK:
        return
    if choice != HOST:
        raise InvalidValue(
            f"environment variable {CHOICE}: '{choice}' given, '{HOST}' (this host only, the "
            f"default) or '{NETWORK}' expected"
        )
    for name in _REMOVED:
        environment.pop(name, None)
    environment["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    environment["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(PROFILE)
    environment["SKIP_DEFAULT_XML"] = "1"  # no profile of the working directory
