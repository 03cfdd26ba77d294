"""Reader of URDF files: text (expanded or converted if needed), elements, meshes."""

from __future__ import annotations

import hashlib
import os
import re
from importlib import import_module
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.mjcf.convert import urdf_of_mjcf

PACKAGE_SCHEME = "package://"
_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_MJCF = re.compile(rb"<mujoco[\s>]")
_BEFORE = {b"<?": b"?>", b"<!--": b"-->"}  # what may stand before the first element, and its end
_XACRO = b"<xacro:"  # an expanded file may still declare the namespace


def urdf_text(file: Path) -> bytes:
    """The URDF in a file; xacro is expanded with default arguments, MJCF is converted.

    Raises:
        ConfigurationError: no file, xacro or MJCF without the package that reads it, or an MJCF
            that no URDF can express.
    """
    try:
        text = file.read_bytes()
    except OSError as error:
        raise ConfigurationError(f"{file}: cannot be read: {error.strerror}") from error
    if is_mjcf(text):
        folder = f"{file.stem}_{hashlib.sha256(str(file).encode() + text).hexdigest()[:16]}"
        return urdf_of_mjcf(file, cache() / folder)
    if not _is_xacro(file, text):
        return text
    try:
        xacro = import_module("xacro")
    except ImportError as error:
        raise ConfigurationError(
            f"{file}: written in xacro, and the Python package 'xacro' is not installed: "
            "`pip install xacro`, or expand it first: `xacro model.urdf.xacro > model.urdf`"
        ) from error
    try:
        expanded: str = xacro.process_file(str(file)).toxml()
    except Exception as error:  # of any class: xacro evaluates expressions of the file
        raise ConfigurationError(f"{file}: xacro cannot expand it: {error}") from error
    return expanded.encode()


def is_translated(file: Path) -> bool:
    """Whether a file has to be expanded or converted before it is a URDF."""
    if not file.is_file():
        return False
    text = file.read_bytes()
    return _is_xacro(file, text) or is_mjcf(text)


def _is_xacro(file: Path, text: bytes) -> bool:
    """Comments aside: an expanded file may still hold what it was made of."""
    if file.suffix == ".xacro":
        return True
    return _XACRO in text and _XACRO in _COMMENT.sub(b"", text)


def is_mjcf(text: bytes) -> bool:
    """Whether a text is MuJoCo's model language."""
    rest = text.lstrip()
    while opened := next((begin for begin in _BEFORE if rest.startswith(begin)), b""):
        rest = rest.partition(_BEFORE[opened])[2].lstrip()
    return _MJCF.match(rest) is not None


def cache() -> Path:
    """Folder for files generated from a model file."""
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "ghc_controller" / "urdf"


def parse_urdf(file: Path, text: bytes | None = None) -> Element:
    """The <robot> element of a URDF; of `text` where that was read already.

    Raises:
        ConfigurationError: as `urdf_text`, or the text is no URDF; names the file.
    """
    try:
        robot = ElementTree.fromstring(urdf_text(file) if text is None else text)
    except ElementTree.ParseError as error:
        raise ConfigurationError(f"{file}: not a URDF: cannot be read as XML: {error}") from error
    if robot.tag != "robot":
        raise ConfigurationError(f"{file}: not a URDF, it has no <robot> element")
    return robot


def root_link(robot: Element) -> str:
    """Name of the link that is no joint's child: the base. Empty when there is none."""
    children = {child.get("link") for child in robot.iterfind("joint/child")}
    names = [link.get("name", "") for link in robot.iterfind("link")]
    return next((name for name in names if name not in children), "")


def place_meshes(robot: Element, urdf: Path) -> None:
    """Replace the names of meshes by the paths of their files."""
    for mesh in robot.iter("mesh"):
        mesh.set("filename", str(resource_path(mesh.get("filename", ""), urdf)))


def resource_path(uri: str, urdf: Path) -> Path:
    """File for `package://name/path` in a URDF, or for a path relative to it.

    The folder `name` is looked for in the folders above the URDF, as a package of robot models
    lays it out, then among the ROS packages that are sourced (AMENT_PREFIX_PATH,
    ROS_PACKAGE_PATH); a URI without a match is taken as relative, and reported when it is opened.
    """
    if not uri.startswith(PACKAGE_SCHEME):
        return urdf.parent / uri
    name = uri.removeprefix(PACKAGE_SCHEME)
    shares = [Path(prefix) / "share" for prefix in _paths_of("AMENT_PREFIX_PATH")]
    for folder in (*urdf.resolve().parents, *shares, *map(Path, _paths_of("ROS_PACKAGE_PATH"))):
        if (folder / name).is_file():
            return folder / name
    return urdf.parent / name


def _paths_of(variable: str) -> list[str]:
    return [path for path in os.environ.get(variable, "").split(os.pathsep) if path]
