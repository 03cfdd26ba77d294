"""The one reader of URDF files: text, expanded from xacro if need be, elements and mesh files."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from ghc_controller.errors import ConfigurationError

PACKAGE_SCHEME = "package://"
_XACRO = b"<xacro:"  # an expanded file may still declare the namespace


def urdf_text(file: Path) -> bytes:
    """The URDF that a file holds; one in xacro's language is expanded, with its own defaults.

    Raises:
        ConfigurationError: no file, an MJCF, or xacro without the package that expands it.
    """
    try:
        text = file.read_bytes()
    except OSError as error:
        raise ConfigurationError(f"{file}: cannot be read: {error.strerror}") from error
    if file.suffix != ".xacro" and _XACRO not in text:
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


def is_xacro(file: Path) -> bool:
    """Whether a file has to be expanded before it is a URDF."""
    return file.suffix == ".xacro" or (file.is_file() and _XACRO in file.read_bytes())


def parse_urdf(file: Path, text: bytes | None = None) -> Element:
    """The <robot> element of a URDF; of `text` where that was read already.

    Raises:
        ConfigurationError: as `urdf_text`, or the text is no URDF; names the file.
    """
    try:
        robot = ElementTree.fromstring(urdf_text(file) if text is None else text)
    except ElementTree.ParseError as error:
        raise ConfigurationError(f"{file}: not a URDF: cannot be read as XML: {error}") from error
    if robot.tag == "mujoco":
        raise ConfigurationError(
            f"{file}: an MJCF of MuJoCo given, a URDF expected: both engines read one file, "
            "and Pinocchio's dynamics come from URDF"
        )
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
    """File that a URDF means by `package://name/path`, or by a path relative to itself.

    The folder `name` is looked for in the folders above the URDF, as a package of robot models
    lays it out; a URI that leads nowhere is taken as relative, to be missed by whoever opens it.
    """
    if not uri.startswith(PACKAGE_SCHEME):
        return urdf.parent / uri
    name = uri.removeprefix(PACKAGE_SCHEME)
    for folder in urdf.resolve().parents:
        if (folder / name).is_file():
            return folder / name
    return urdf.parent / name
