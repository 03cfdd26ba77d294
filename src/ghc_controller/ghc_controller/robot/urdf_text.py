"""Text of a URDF: as it stands in the file, or expanded from xacro."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from ghc_controller.errors import ConfigurationError

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
