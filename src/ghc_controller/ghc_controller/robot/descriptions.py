"""Models by name from the Python package robot_descriptions, including MuJoCo Menagerie.

That package clones a repository when a name is imported. Here only data already in the user's
cache are used: loading a robot never starts a download.
"""

from __future__ import annotations

import os
import re
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from ghc_controller.errors import ConfigurationError

PACKAGE = "robot_descriptions"
_REPOSITORY = re.compile(r"clone_to_cache\(\s*\"([^\"]+)\"")
# Repository -> package of the index that carries its models.
_CARRIED = {"example-robot-data": "example-robot-data", "mujoco_menagerie": "mujoco-menagerie"}


def described_model(name: str) -> Path:
    """URDF or MJCF of a description such as panda_description or panda_mj_description.

    Raises:
        ConfigurationError: the package is not installed or has no such name, or the model is not
            in the cache; names the missing folder and a package that contains the model.
    """
    if find_spec(PACKAGE) is None:
        raise ConfigurationError(
            f"description '{name}': the Python package '{PACKAGE}' is not installed: "
            f"`pip install {PACKAGE}`"
        )
    spec = find_spec(f"{PACKAGE}.{name}") if name.isidentifier() else None
    if spec is None or spec.origin is None:
        raise ConfigurationError(f"description '{name}': {PACKAGE} has no such name")
    match = _REPOSITORY.search(Path(spec.origin).read_text(encoding="utf-8"))
    repository = match[1] if match else ""
    folder = _cache_of(repository)
    if not folder.is_dir():
        package = _CARRIED.get(repository)
        other = f"; `pip install {package}` provides the model too" if package else ""
        raise ConfigurationError(
            f"description '{name}': its data are not in the cache, '{folder}' is missing: "
            f"`python -c 'from {PACKAGE} import {name}'` downloads them{other}"
        )
    try:
        module = import_module(f"{PACKAGE}.{name}")
    except Exception as error:  # of any class: it runs git on the cache
        raise ConfigurationError(
            f"description '{name}': {type(error).__name__}: {' '.join(str(error).split())}"
        ) from error
    path = getattr(module, "URDF_PATH", "") or getattr(module, "MJCF_PATH", "")
    if not path:
        raise ConfigurationError(f"description '{name}': it has neither a URDF nor an MJCF")
    return Path(path)


def _cache_of(repository: str) -> Path:
    """Folder of a repository in the user's cache."""
    base = os.environ.get("ROBOT_DESCRIPTIONS_CACHE") or str(Path.home() / ".cache" / PACKAGE)
    known = import_module(f"{PACKAGE}._repositories").REPOSITORIES
    entry = known.get(repository)
    return Path(base).expanduser() / (entry.cache_path if entry else repository)
