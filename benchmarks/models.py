"""Robot models of packages that benchmarks and studies need beside those of the stack."""

from __future__ import annotations

import sys
from pathlib import Path

from tools.model_packages import install_missing
from tools.workspace.layout import Layout

ROOT = Path(__file__).resolve().parents[1]
STUDY_ROBOTS = Path(__file__).resolve().parent / "study_robots"  # robot.yaml and scene files


def install_model(package: str) -> None:
    """Install a package of robot models unless it is there; SetupError when that fails."""
    install_missing(package, Layout(ROOT))


def install_study_model(package: str) -> None:
    """As install_model, for packages that only studies use: from a lock of their own."""
    layout = Layout(ROOT)
    install_missing(package, layout, layout.study_models_lock(sys.version_info[:2]))


def install_cluster() -> None:
    """Install dask.distributed, with which `make compare` runs on other machines."""
    layout = Layout(ROOT)
    lock = layout.cluster_lock(sys.version_info[:2])
    install_missing("distributed", layout, lock, "runs on other machines")
