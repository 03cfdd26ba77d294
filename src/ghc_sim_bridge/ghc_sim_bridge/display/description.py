"""The text of a URDF for programs that do not know where its files are."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.urdf_text import resource_path, urdf_text

_FILES = ("mesh", "texture")
_SCHEMES = ("file://", "http://", "https://")


def description_of(urdf: Path) -> str:
    """Text of a URDF whose meshes are named as file://, which RViz and Foxglove open.

    Raises:
        ConfigurationError: no file, or no XML.
    """
    try:
        robot = ElementTree.fromstring(urdf_text(urdf))
    except ElementTree.ParseError as error:
        raise ConfigurationError(f"{urdf}: cannot be read as XML: {error}") from error
    for kind in _FILES:
        for element in robot.iter(kind):
            name = element.get("filename", "")
            if name and not name.startswith(_SCHEMES):
                element.set("filename", resource_path(name, urdf).resolve().as_uri())
    return ElementTree.tostring(robot, encoding="unicode")
