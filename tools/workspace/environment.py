"""The environment of the commands that the set-up runs.

A Python of a virtual environment with ROS 2 wheels starts itself anew with LD_LIBRARY_PATH and a
guard variable set, and its children inherit both. A child of another environment would then load
the parent's libraries, and one that keeps the guard without the path finds none: so both are
dropped here, and every environment finds its own.
"""

from __future__ import annotations

import ast
import os
from collections.abc import Mapping
from pathlib import Path

from tools.workspace.layout import Layout, Way

WHEELS_GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
_SYSTEM_CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")

# They would change what is installed or how: not taken over from the caller's shell.
_DROPPED = (
    WHEELS_GUARD,
    "PYTHONDONTWRITEBYTECODE",  # without byte code an import of rclpy takes 0.3 s more
    "PYTHONHOME",
    "CONDA_PREFIX",
    "COLCON_PREFIX_PATH",
)
_DROPPED_WITH_WHEELS = (
    "AMENT_PREFIX_PATH",
    "CMAKE_PREFIX_PATH",
    "LD_LIBRARY_PATH",
    "PYTHONPATH",
)

# What pip is told about the package index holds for uv too, under other names.
_UV_NAMES = {
    "cert": "SSL_CERT_FILE",
    "index-url": "UV_DEFAULT_INDEX",
    "extra-index-url": "UV_INDEX",
}


def step_environment(layout: Layout, way: Way, caller: Mapping[str, str]) -> dict[str, str]:
    """Environment in which `python`, `cmake` and `colcon` are those of the workspace."""
    dropped = _DROPPED + (_DROPPED_WITH_WHEELS if way is Way.WHEELS else ())
    result = {name: value for name, value in caller.items() if name not in dropped}
    result["VIRTUAL_ENV"] = str(layout.venv)
    result["PATH"] = os.pathsep.join(
        [str(layout.venv / "bin"), caller.get("PATH", "/usr/local/bin:/usr/bin:/bin")]
    )
    if way is Way.WHEELS:
        result["AMENT_PREFIX_PATH"] = result["CMAKE_PREFIX_PATH"] = str(layout.venv)
    return result


def uv_settings(pip_config: str, caller: Mapping[str, str]) -> dict[str, str]:
    """Settings of uv that say what `pip config list` says; the caller's own ones win."""
    result = {}
    if _SYSTEM_CERTIFICATES.is_file():
        result["UV_SYSTEM_CERTS"] = "1"
    for line in pip_config.splitlines():
        name, separator, value = line.partition("=")
        option = _UV_NAMES.get(name.rpartition(".")[2])
        if option and separator:
            result[option] = " ".join(str(ast.literal_eval(value)).split())
    return {name: value for name, value in result.items() if name not in caller}
