"""What this machine offers: interpreters, programs, room. Tests put other answers in its place."""

from __future__ import annotations

import json
import os
import platform
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

_QUESTIONS = """
import importlib.util, json, os, platform, sys, sysconfig
print(json.dumps({
    "path": getattr(sys, "_base_executable", None) or sys.executable,
    "version": list(sys.version_info[:3]),
    "implementation": platform.python_implementation(),
    "venv": all(importlib.util.find_spec(name) for name in ("venv", "ensurepip")),
    "headers": os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")),
}))
"""


@dataclass(frozen=True)
class Interpreter:
    """A Python that starts."""

    path: str  # of a virtual environment's Python: the one that it was made from
    version: tuple[int, ...]
    implementation: str = "CPython"
    venv: bool = True  # can make a virtual environment with pip in it
    headers: bool = True  # its C headers are there

    @property
    def name(self) -> str:
        return f"Python {'.'.join(map(str, self.version))} ({self.path})"


class Machine:
    """Answers of the real machine."""

    def interpreter(self, command: str) -> Interpreter | None:
        """The interpreter behind a command; None when there is none or it does not start."""
        environment = {
            name: value
            for name, value in os.environ.items()
            if name not in ("PYTHONHOME", "PYTHONPATH", "__PYVENV_LAUNCHER__")
        }
        try:
            run = subprocess.run(
                [command, "-c", _QUESTIONS],
                capture_output=True,
                text=True,
                timeout=60,
                env=environment,
                check=True,
            )
            answers = json.loads(run.stdout)
            answers["version"] = tuple(answers["version"])
            return Interpreter(**answers)
        except (OSError, subprocess.SubprocessError, ValueError, TypeError):
            return None

    def compiler(self) -> str | None:
        """The C++ compiler that CMake would take."""
        named = os.environ.get("CXX", "").split()
        for command in [*named[:1], "c++", "g++", "clang++"]:
            found = shutil.which(command)
            if found:
                return found
        return None

    def free_bytes(self, folder: Path) -> int:
        """Room left on the disk of a folder [bytes]."""
        return shutil.disk_usage(folder).free

    def architecture(self) -> str:
        """Operating system and processor, such as `Linux x86_64`."""
        return f"{platform.system()} {platform.machine()}"

    def ros_distribution(self) -> str:
        """Name of the ROS 2 installation that is sourced; empty when there is none."""
        return os.environ.get("ROS_DISTRO", "")
