"""Hosts as network namespaces around a hub, inside an unprivileged namespace."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from benchmarks.hosts.conditions import Conditions

UNSHARE = ("unshare", "--map-root-user", "--net", "--mount")
SUBNET = "10.78.0."
# With shared memory of its own, as another host has it.
_KEEPER = "mount -t tmpfs tmpfs /dev/shm && echo && exec sleep 100000"


@dataclass(frozen=True, slots=True)
class Network:
    """Hosts by name, and what lies between them."""

    enter: Mapping[str, Sequence[str]]  # host -> what a command begins with to run there
    control: Path  # pipe to the hub

    def set(self, conditions: Conditions) -> None:
        """Conditions for frames that are sent from now on."""
        with self.control.open("w", encoding="utf-8") as pipe:
            pipe.write(conditions.line() + "\n")
        time.sleep(0.02)  # until the hub has read it


def namespaces_work() -> str:
    """Reason why namespaces are not available; "" if they are."""
    probe = "ip link add name here type veth peer name there && mount -t tmpfs tmpfs /dev/shm"
    try:
        run = subprocess.run([*UNSHARE, "sh", "-c", probe], capture_output=True, text=True)
    except FileNotFoundError as error:
        return str(error)
    return run.stderr.strip() if run.returncode else ""


@contextmanager
def network(names: Sequence[str], folder: Path) -> Iterator[Network]:
    """As many hosts, each with a cable to the hub; the hub is in the namespace of the caller."""
    started: list[subprocess.Popen[str]] = []
    enter: dict[str, Sequence[str]] = {}
    control = folder / "hub.pipe"
    control.unlink(missing_ok=True)
    os.mkfifo(control)
    try:
        for number, name in enumerate(names, start=1):
            keeper = _start(["unshare", "--net", "--mount", "sh", "-c", _KEEPER])
            started.append(keeper)
            place = (f"--target={keeper.pid}", f"--wd={Path.cwd()}")
            enter[name] = inside = ("nsenter", *place, "--net", "--mount")
            hub_end, host_end = f"hub{number}", f"host{number}"
            _run("ip", "link", "add", hub_end, "type", "veth", "peer", "name", host_end)
            _run("ip", "link", "set", host_end, "netns", str(keeper.pid))
            _run("ip", "link", "set", hub_end, "up")
            _run(*inside, "ip", "link", "set", "lo", "up")
            _run(*inside, "ip", "addr", "add", f"{SUBNET}{number}/24", "dev", host_end)
            _run(*inside, "ip", "link", "set", host_end, "up")
            _run(*inside, sys.executable, "-m", "benchmarks.hosts.checksums", host_end)
            _run(*inside, "ip", "route", "add", "default", "dev", host_end)  # for multicast
        ends = [f"hub{number}" for number in range(1, len(names) + 1)]
        hub = [sys.executable, "-m", "benchmarks.hosts.hub", str(control), *ends]
        started.append(_start(hub))
        yield Network(enter, control)
    finally:
        for process in started:
            process.kill()
            process.wait()
        control.unlink(missing_ok=True)


def _start(command: Sequence[str]) -> subprocess.Popen[str]:
    """A process that prints a line when it is ready."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    process.stdout.readline()
    return process


def _run(*words: str) -> None:
    subprocess.run(words, check=True, capture_output=True, text=True)
