"""The nodes of a session on separate hosts."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from benchmarks.faults.session import Session
from benchmarks.hosts.namespaces import Network
from ghc_sim_bridge.run.processes import NodeProcess

HOSTS = ("robot", "control", "operator")
# The monitor listens beside the robot: it sees what is applied, and when commands arrive.
HOST_OF = {"sim_bridge": "robot", "monitor": "robot", "controller": "control"}
OPEN = {"GHC_NETWORK": "network", "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}


class HostsSession(Session):
    """Bridge and monitor on one host, the controller on another one; this process on a third."""

    def __init__(self, folder: Path, control_dt: float, network: Network) -> None:
        """See Session."""
        self._network = network
        os.environ.update(OPEN)
        super().__init__(folder, control_dt)
        self._environment |= OPEN

    def _run(self, name: str, command: list[Any]) -> NodeProcess:
        return super()._run(name, [*self._network.enter[HOST_OF[name]], *command])
