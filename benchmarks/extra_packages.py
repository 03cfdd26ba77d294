"""Packages that only the benchmark needs: installed from their lock when it first runs."""

from __future__ import annotations

import importlib.util
import os
import sys

from tools.workspace.environment import step_environment, uv_settings
from tools.workspace.layout import Layout, Way
from tools.workspace.run import Runner


def install_missing(module: str, layout: Layout) -> None:
    """Install the benchmark's lock unless `module` is there; SetupError when that fails."""
    if importlib.util.find_spec(module) is not None:
        return
    lock = layout.bench_lock(sys.version_info[:2])
    print(f"bench: installing {lock.relative_to(layout.root)}", file=sys.stderr, flush=True)
    run = Runner(layout.root)
    environment = step_environment(layout, Way.WHEELS, os.environ)
    pip_config = run.output([sys.executable, "-m", "pip", "config", "list"], environment)
    run(
        [str(layout.venv / "bin" / "uv"), "pip", "install", "--require-hashes", "-r", str(lock)],
        {**environment, **uv_settings(pip_config, environment)},
        "the packages of the benchmark could not be installed",
    )
    importlib.invalidate_caches()
