"""A URDF with some of its joints fixed at zero, as a file that every reader of a URDF can use."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from xml.etree import ElementTree

from ghc_controller.errors import ConfigurationError, UnknownName

_OF_MOVING_JOINTS = ("axis", "limit", "dynamics", "mimic", "safety_controller", "calibration")


def with_fixed_joints(
    urdf: Path, joints: Sequence[str], resource: Callable[[str, Path], Path]
) -> Path:
    """Path of a copy of `urdf` with `joints` fixed at zero, in the user's cache folder.

    The name of the copy holds a digest of its content: it is written once, and never stale.

    Args:
        resource: file that a mesh's URI means, given the URI and the URDF.

    Raises:
        ConfigurationError: the URDF cannot be read, or the copy cannot be written.
        UnknownName: a joint that the URDF does not have.
    """
    try:
        robot = ElementTree.parse(urdf).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise ConfigurationError(f"{urdf}: cannot be read as XML: {error}") from error
    known = {joint.get("name", ""): joint for joint in robot.iterfind("joint")}
    for name in joints:
        if name not in known:
            raise UnknownName(f"joint of {urdf}", name, list(known))
        _fix(known[name])
    for mesh in robot.iter("mesh"):
        mesh.set("filename", str(resource(mesh.get("filename", ""), urdf)))
    text = ElementTree.tostring(robot)
    digest = hashlib.sha256(text).hexdigest()[:16]
    return _written(_folder() / f"{urdf.stem}-{digest}.urdf", text)


def _fix(joint: ElementTree.Element) -> None:
    joint.set("type", "fixed")
    for tag in _OF_MOVING_JOINTS:
        for part in joint.findall(tag):
            joint.remove(part)


def _folder() -> Path:
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache) / "ghc_controller" / "urdf"


def _written(path: Path, text: bytes) -> Path:
    """The path with that content; processes that write it at once leave one whole file."""
    if path.exists():
        return path
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            file.write(text)
        Path(file.name).replace(path)
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be written: {error.strerror}") from error
    return path
