"""Entry of the set-up: `python3 -m tools.workspace [--python COMMAND]`, from the root."""

from __future__ import annotations

import argparse
import fcntl
import os
import resource
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tools.workspace import checks
from tools.workspace.build_steps import Core, Messages, PythonPackages
from tools.workspace.environment_steps import Packages, VirtualEnvironment
from tools.workspace.errors import SetupError
from tools.workspace.layout import Layout, Way
from tools.workspace.machine import Machine
from tools.workspace.run import Runner
from tools.workspace.step import Context, Step

# Steps of one group run side by side.
Group = tuple[type[Step], ...]
STEPS: tuple[Group, ...] = (
    (VirtualEnvironment,),
    (Packages,),
    (Messages, Core),
    (PythonPackages,),
)

INTERRUPTED = 130  # exit code that shells give to a command ended by SIGINT


def set_up(context: Context, groups: Sequence[Group] = STEPS) -> int:
    """Run the steps whose inputs changed; return how many ran."""
    layout = context.layout
    checks.check_sources([layout.uv_lock, layout.wheel_includes])
    if not layout.install.exists():
        checks.check_compiler(context.machine)  # told now, and not after a gigabyte of packages
    count = 0
    for number, kinds in enumerate(groups, start=1):
        steps = [step for step in (kind(context) for kind in kinds) if not step.is_done()]
        if not steps:
            continue
        _say(f"[{number}/{len(groups)}] {', '.join(step.title for step in steps)}")
        started, cpu = time.monotonic(), _of_children()
        with ThreadPoolExecutor(len(steps)) as side_by_side:
            for done in [side_by_side.submit(step.run) for step in steps]:
                done.result()
        took, cpu = time.monotonic() - started, _of_children() - cpu
        _say(f"[{number}/{len(groups)}] done in {took:.0f} s ({cpu:.0f} s of processors)")
        count += len(steps)
    return count


def main() -> int:
    """Set up the workspace; 0 when it is ready."""
    parser = argparse.ArgumentParser(prog="python3 -m tools.workspace", description=__doc__)
    parser.add_argument("--python", metavar="COMMAND", help="the Python of .venv (3.11 or 3.12)")
    parser.add_argument("--only-packages", action="store_true", help="build nothing yet")
    parser.add_argument("--quiet", action="store_true", help="say nothing when up to date")
    arguments = parser.parse_args()
    root = Path(__file__).resolve().parents[2]
    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    try:
        machine = Machine()
        context = Context(
            layout=Layout(root),
            way=checks.choose_way(machine),
            machine=machine,
            run=Runner(root),
            caller=os.environ,
            asked_python=arguments.python,
        )
        with _Alone(root):
            ran = set_up(context, STEPS[:2] if arguments.only_packages else STEPS)
    except SetupError as error:
        print(f"set-up: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("set-up: interrupted; `make setup` goes on from here", file=sys.stderr)
        return INTERRUPTED
    if arguments.quiet and not ran:
        return 0
    source = "wheels in .venv" if context.way is Way.WHEELS else "the sourced installation"
    _say(f"set-up: {'ready' if ran else 'up to date'} (ROS 2 Jazzy from {source})")
    return 0


def _of_children() -> float:
    """Processor time of the commands that have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class _Alone:
    """Holds a lock on the root folder, so that two set-ups do not work on the same files."""

    def __init__(self, root: Path) -> None:
        self._folder = os.open(root, os.O_RDONLY)

    def __enter__(self) -> None:
        try:
            fcntl.flock(self._folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            _say("set-up: another one is at work here; waiting for it to end")
            fcntl.flock(self._folder, fcntl.LOCK_EX)

    def __exit__(self, *_: object) -> None:
        os.close(self._folder)


def _say(text: str) -> None:
    print(text, flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
