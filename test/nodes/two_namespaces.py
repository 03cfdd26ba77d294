"""Bridge and controller in one network namespace, a stranger in another one, as a process.

`unshare --map-root-user --net two_namespaces.py FOLDER [--patient]` prints the reports of
the stranger and of a friend beside the nodes (see wire_tapper.py). The nodes are started by hand,
that is without any setting but the environment's; the stranger knows the address of their host as
a static peer.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from ghc_sim_bridge.run.executables import find_executable

HERE, THERE = "10.77.0.1", "10.77.0.2"
SECONDS = "8.0"  # of stranger and friend at least
PATIENCE = 60.0  # [s] for what must happen: to the friend always, to the stranger if `--patient`
TAPPER = str(Path(__file__).with_name("wire_tapper.py"))


def run(*words: str) -> None:
    """A command that has to succeed."""
    subprocess.run(words, check=True, capture_output=True, text=True)


@contextmanager
def other_namespace() -> Iterator[Sequence[str]]:
    """A namespace at the other end of a cable; how a command is started in it."""
    # With shared memory of its own, as another host has it.
    script = "mount -t tmpfs tmpfs /dev/shm && echo && exec sleep 1000"
    keeper = subprocess.Popen(
        ["unshare", "--net", "--mount", "sh", "-c", script], stdout=subprocess.PIPE
    )
    try:
        assert keeper.stdout is not None
        keeper.stdout.readline()  # it is in its namespace now
        inside = ("nsenter", f"--target={keeper.pid}", "--net", "--mount")
        run("ip", "link", "add", "here", "type", "veth", "peer", "name", "there")
        run("ip", "link", "set", "there", "netns", str(keeper.pid))
        for enter, device, address in (((), "here", HERE), (inside, "there", THERE)):
            run(*enter, "ip", "link", "set", "lo", "up")
            run(*enter, "ip", "addr", "add", f"{address}/24", "dev", device)
            run(*enter, "ip", "link", "set", device, "up")
        # With a multicast route too, as a host on a local network has one.
        run("ip", "route", "add", "default", "dev", "here")
        run(*inside, "ip", "route", "add", "default", "dev", "there")
        yield inside
    finally:
        keeper.kill()
        keeper.wait()


def tap(enter: Sequence[str], environment: Mapping[str, str], *words: str) -> subprocess.Popen:
    """Start a tapper."""
    command = [*enter, sys.executable, TAPPER, *words]
    return subprocess.Popen(command, env=dict(environment), stdout=subprocess.PIPE, text=True)


def wait_for(log: Path, words: str) -> None:
    """Until a node has printed some words."""
    end = time.monotonic() + PATIENCE
    while words not in log.read_text(encoding="utf-8"):
        assert time.monotonic() < end, log
        time.sleep(0.05)


def main() -> None:
    """Start all, report, end all."""
    folder = Path(sys.argv[1])
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("ROS_A", "ROS_S", "FAST"))}
    clean |= {"ROS_LOG_DIR": str(folder)}
    # A peer of the nodes' own side that the environment happens to name.
    by_hand = clean | {"ROS_STATIC_PEERS": THERE, "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
    scene, robot = ["scene:=kuka_lwr", "-p", "mode:=realtime"], ["robot:=kuka_lwr"]
    nodes: list[subprocess.Popen[bytes]] = []
    with other_namespace() as enter:
        try:
            for package, executable, words in (
                ("ghc_sim_bridge", "sim_bridge", scene),
                ("ghc_controller", "controller", robot),
            ):
                path = str(find_executable(package, executable))
                command = [path, "--ros-args", "-p", *words]
                log = (folder / f"{executable}.log").open("wb")
                nodes.append(
                    subprocess.Popen(command, env=by_hand, stdout=log, stderr=subprocess.STDOUT)
                )
            for executable, word in (("sim_bridge", "running"), ("controller", "ready")):
                wait_for(folder / f"{executable}.log", word)
            patient = ("--patience", str(PATIENCE))
            outside = patient if "--patient" in sys.argv else ()
            stranger = tap(enter, clean | {"ROS_STATIC_PEERS": HERE}, SECONDS, *outside)
            friend = tap((), clean, SECONDS, *patient, "--listen")
            reports = [
                json.loads(each.communicate(timeout=2 * PATIENCE)[0])
                for each in (stranger, friend)
            ]
            print(json.dumps(dict(zip(("stranger", "friend"), reports, strict=True))))
        finally:
            for node in nodes:
                node.send_signal(signal.SIGINT)
            for node in nodes:
                node.wait(timeout=30.0)


if __name__ == "__main__":
    main()
