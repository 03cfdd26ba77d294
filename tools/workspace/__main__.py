"""Entry of the set-up: `python3 -m tools.workspace [--python COMMAND]`, from the root."""

from __future__ import annotations

import argparse
import fcntl
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from tools.workspace import checks
from tools.workspace.build_steps import Messages, PythonPackages
from tools.workspace.environment_steps import Packages, VirtualEnvironment
from tools.workspace.errors import SetupError
from tools.workspace.layout import Layout, Way
from tools.workspace.machine import Machine
from tools.workspace.run import Runner
from tools.workspace.step import Context, Step

STEPS: tuple[type[Step], ...] = (
    VirtualEnvironment,
    Packages,
    Messages,
    PythonPackages,
)

INTERRUPTED = 130  # exit code that shells give to a command ended by SIGINT


def set_up(context: Context, kinds: Sequence[type[Step]] = STEPS) -> int:
    """Run the steps whose inputs changed; return how many ran."""
    layout = context.layout
    checks.check_sources([layout.uv_lock, layout.wheel_includes])
    steps = [kind(context) for kind in kinds]
    if not layout.install.exists():
        checks.check_compiler(context.machine)  # told now, and not after a gigabyte of packages
    count = 0
    for number, step in enumerate(steps, start=1):
        if step.is_done():
            continue
        _say(f"[{number}/{len(steps)}] {step.title}")
        started = time.monotonic()
        step.run()
        _say(f"[{number}/{len(steps)}] done in {time.monotonic() - started:.0f} s")
        count += 1
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
