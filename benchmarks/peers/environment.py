"""A virtual environment for each peer, since their Pinocchio conflicts with ours."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from tools.workspace.environment import step_environment, uv_settings
from tools.workspace.layout import Layout, Way
from tools.workspace.run import Runner

_STAMP = "installed.txt"  # the lock that the environment was made from


def peer_python(peer: str, layout: Layout) -> Path:
    """The Python of a peer's environment, which is created if missing or outdated.

    Raises:
        SetupError: the packages could not be installed.
    """
    folder = layout.peer_environment(peer)
    lock = layout.peer_lock(peer, sys.version_info[:2])
    python, stamp = folder / "bin" / "python", folder / _STAMP
    if stamp.is_file() and stamp.read_bytes() == lock.read_bytes():
        return python
    print(f"bench: installing {lock.relative_to(layout.root)}", file=sys.stderr, flush=True)
    run = Runner(layout.root)
    environment = step_environment(layout, Way.WHEELS, os.environ)
    pip_config = run.output([sys.executable, "-m", "pip", "config", "list"], environment)
    settings = {**environment, **uv_settings(pip_config, environment)}
    uv = str(layout.venv / "bin" / "uv")
    what = f"the environment of {peer}"
    run([uv, "venv", "--clear", "--python", sys.executable, str(folder)], settings, what)
    install = [uv, "pip", "install", "--python", str(python), "--require-hashes", "-r", str(lock)]
    run(install, settings, what)
    stamp.write_bytes(lock.read_bytes())
    return python
