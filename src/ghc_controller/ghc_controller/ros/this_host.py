"""Closed by default: discovery and data of a process stay on this host.

`ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST` alone closes discovery by multicast. It leaves sockets on
all interfaces, so that whoever names this host as a static peer reads and writes every topic; and
the static peers of this process are still called. Here the middleware gets sockets of the loopback
interface only. Call before `rclpy.init`, which reads all of this once.
"""

from __future__ import annotations

import os
from collections.abc import MutableMapping
from pathlib import Path

from ghc_controller.errors import InvalidValue

CHOICE = "GHC_NETWORK"
HOST, NETWORK = "host", "network"
PROFILE = Path(__file__).with_name("this_host.xml")
# What would lead out of the host, or to another profile.
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
