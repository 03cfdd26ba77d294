"""Where things are, and which of the two ways to ROS 2 this workspace takes."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from pathlib import Path

MESSAGES = "ghc_msgs"


class Way(enum.Enum):
    """Where ROS 2 comes from."""

    WHEELS = "wheels"  # ROS 2 Jazzy as wheels in .venv
    SYSTEM = "system"  # a sourced ROS 2 Jazzy installation


@dataclass(frozen=True)
class Layout:
    """Paths of one workspace."""

    root: Path

    @property
    def venv(self) -> Path:
        return self.root / ".venv"

    @property
    def python(self) -> Path:
        return self.venv / "bin" / "python"

    @property
    def source(self) -> Path:
        return self.root / "src"

    @property
    def build(self) -> Path:
        return self.root / "build"

    @property
    def install(self) -> Path:
        return self.root / "install"

    @property
    def log(self) -> Path:
        return self.root / "log"

    @property
    def uv_lock(self) -> Path:
        return self.root / "requirements" / "uv.txt"

    @property
    def wheel_includes(self) -> Path:
        return self.root / "tools" / "wheel_includes.cmake"

    def lock(self, way: Way, version: tuple[int, ...]) -> Path:
        """The lock file of a way and a Python version."""
        kind = "lock" if way is Way.WHEELS else "lock-noros"
        return self.root / "requirements" / f"{kind}-py{version[0]}.{version[1]}.txt"

    def models_lock(self, version: tuple[int, ...]) -> Path:
        """The lock file of the robot models that come as Python packages."""
        return self.root / "requirements" / f"models-py{version[0]}.{version[1]}.txt"

    def study_models_lock(self, version: tuple[int, ...]) -> Path:
        """The lock file of the robot models that only studies use."""
        return self.root / "requirements" / f"study-models-py{version[0]}.{version[1]}.txt"

    def cluster_lock(self, version: tuple[int, ...]) -> Path:
        """The lock file of what `make compare` needs for other machines."""
        return self.root / "requirements" / f"cluster-py{version[0]}.{version[1]}.txt"

    def peer_lock(self, peer: str, version: tuple[int, ...]) -> Path:
        """The lock file of a controller of others that `make bench` measures beside ours."""
        return self.root / "requirements" / f"peers-{peer}-py{version[0]}.{version[1]}.txt"

    def peer_environment(self, peer: str) -> Path:
        """The virtual environment that holds it."""
        return self.venv / "peers" / peer

    def docs_lock(self, version: tuple[int, ...]) -> Path:
        """The lock file of what `make docs` builds the site with."""
        return self.root / "requirements" / f"docs-py{version[0]}.{version[1]}.txt"

    @property
    def docs_venv(self) -> Path:
        """Environment of `make docs`: in front of .venv, whose packages it sees."""
        return self.venv / "docs"

    @property
    def site(self) -> Path:
        """Where `make docs` writes the site."""
        return self.build / "site"

    def python_packages(self) -> list[Path]:
        """The packages of src/ that setup.py installs (ament_python)."""
        return sorted(path.parent for path in self.source.glob("*/setup.py"))

    def core_sources(self) -> list[Path]:
        """What the extension of the controller is built from."""
        folders = sorted(path.parent for path in self.source.glob("*/*/core/CMakeLists.txt"))
        files = [path for folder in folders for path in sorted(folder.rglob("*.[ch]pp"))]
        return [*files, *(folder / "CMakeLists.txt" for folder in folders), *self._builders()]

    @property
    def core_build(self) -> Path:
        """Folder in which CMake builds the core of the controller."""
        return self.build / "core"

    def core_builder(self) -> Path:
        """The script that builds it."""
        return self.source / "ghc_controller" / "build_core.py"

    def core_extensions(self) -> list[Path]:
        """The extensions that were built, beside their sources; what should be where none is."""
        folders = sorted(path.parent for path in self.source.glob("*/*/core/CMakeLists.txt"))
        return [next(folder.glob("native*.so"), folder / "native.so") for folder in folders]

    def _builders(self) -> list[Path]:
        names = ("build_core.py", "pyproject.toml")
        return sorted(path for name in names for path in self.source.glob(f"*/{name}"))

    def messages(self) -> Path:
        """The package with the interfaces."""
        return self.source / MESSAGES

    @property
    def wheel_interfaces(self) -> Path:
        """Folder of the interface packages that are missing among the wheels."""
        return self.root / "tools" / "wheel_interfaces"

    def interfaces(self, way: Way) -> list[Path]:
        """All packages with interfaces that a way builds."""
        found = sorted(path.parent for path in self.wheel_interfaces.glob("*/package.xml"))
        return [*(found if way is Way.WHEELS else []), self.messages()]
