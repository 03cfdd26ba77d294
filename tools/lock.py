"""Write the lock files: `make lock`, or `make lock UPGRADE=1` for newer versions.

Every lock is made by the pinned uv and holds hashes. The ones without ROS are the same versions as
the full ones, less what ROS 2 needs; those of the robot models and of
the cluster hold what comes on top. Those of the peers and of the site are of environments of their
own.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from tools.workspace.checks import SUPPORTED
from tools.workspace.layout import Layout, Way

PEERS = ("tsid", "placo")
_OWN = ("app.in", "build.in", "dev.in")


def main() -> int:
    """Write requirements/uv.txt and two locks for each Python; 0 when all went well."""
    root = Path(__file__).resolve().parents[1]
    layout = Layout(root)
    uv = shutil.which("uv", path=str(layout.venv / "bin")) or shutil.which("uv")
    if uv is None:
        print("lock: no uv in .venv; run `make setup` first", file=sys.stderr)
        return 1
    upgrade = ["--upgrade"] if "--upgrade" in sys.argv[1:] else []
    jobs: list[tuple[Path, list[str]]] = [(layout.uv_lock, ["--universal", "requirements/uv.in"])]
    for version in SUPPORTED:
        python = ["--python-version", f"{version[0]}.{version[1]}"]
        own = [f"requirements/{name}" for name in _OWN]
        full = layout.lock(Way.WHEELS, version)
        same = ["--constraints", str(full.relative_to(root))]
        jobs.append((full, [*python, *upgrade, *own, "requirements/ros.in"]))
        jobs.append((layout.lock(Way.SYSTEM, version), [*python, *same, *own]))
        models = ["requirements/models.in"]
        jobs.append((layout.models_lock(version), [*python, *upgrade, *same, *models]))
        study = ["requirements/study-models.in"]
        jobs.append((layout.study_models_lock(version), [*python, *upgrade, *same, *study]))
        cluster = ["requirements/cluster.in"]
        jobs.append((layout.cluster_lock(version), [*python, *upgrade, *same, *cluster]))
        for peer in PEERS:
            other = f"requirements/peers-{peer}.in"
            jobs.append((layout.peer_lock(peer, version), [*python, *upgrade, other]))
        # Not the same versions: Sphinx needs an older docutils than colcon takes.
        jobs.append((layout.docs_lock(version), [*python, *upgrade, "requirements/docs.in"]))
    for target, arguments in jobs:
        name = str(target.relative_to(root))
        print(f"lock: {name}", flush=True)
        command = [uv, "pip", "compile", "--quiet", "--generate-hashes", "--no-emit-index-url"]
        command += ["--no-emit-find-links", "--custom-compile-command", "make lock"]
        environment = {"UV_SYSTEM_CERTS": "1", **os.environ}
        run = subprocess.run(
            [*command, *arguments, "-o", name], cwd=root, env=environment, check=False
        )
        if run.returncode != 0:
            return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
