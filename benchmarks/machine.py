"""Description of the machine, without names of hosts, people or folders."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from benchmarks.code_version import commit

_PACKAGES = ("numpy", "pin", "daqp", "proxsuite", "mujoco-core", "icub-models")


def machine_facts() -> dict[str, Any]:
    """CPU, cores, versions, and the commit that is measured."""
    return {
        "cpu": _cpu_model(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {name: found for name in _PACKAGES if (found := _version(name))},
        "commit": commit(),
    }


def load_average() -> float:
    """Average number of running or waiting processes in the last minute, including this one."""
    return round(os.getloadavg()[0], 2)


def _cpu_model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown"
    fields = dict(line.split(":", 1) for line in lines if ":" in line)
    facts = {name.strip(): value.strip() for name, value in fields.items()}
    numbers = [facts.get(name, "?") for name in ("cpu family", "model")]
    return f"{facts.get('model name', 'unknown')} (family {numbers[0]}, model {numbers[1]})"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
