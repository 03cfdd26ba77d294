"""Location of a robot's URDF: next to its robot.yaml, or in an installed Python package.

```yaml
urdf: my_arm.urdf                                   # relative to robot.yaml
urdf: {package: my-models, file: share/my/arm.urdf} # in the files of a Python package
urdf: package://my_description/urdf/my_arm.urdf     # in a ROS package that is sourced
urdf: {description: panda_mj_description}           # of robot_descriptions, if in its cache
urdf:                                               # with changes, see urdf_changes.py
  package: my-models                                # without it the file is relative to robot.yaml
  file: share/my/walker.urdf
  root: right_sole                                  # link that becomes the base
  locked: [left_wrist]                              # joints that stay at zero
  frames: {tip: {link: left_hand, position: [0, 0, 0.3]}}  # [m] in the link, with its axes
```
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path, PurePosixPath

import numpy as np

from ghc_controller.errors import ConfigurationError, InvalidField
from ghc_controller.robot.descriptions import described_model
from ghc_controller.robot.urdf_changes import UrdfChanges
from ghc_controller.robot.urdf_text import resource_path
from ghc_controller.schema.declared import declared
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read


@dataclass(frozen=True, slots=True)
class FramePlace:
    """A frame that is added to a URDF."""

    link: str = declared("link of the URDF")
    position: tuple[float, float, float] = declared("in the link, with its axes", unit="m")


@dataclass(frozen=True, slots=True)
class UrdfFields:
    """The section `urdf` of robot.yaml, if it is not just a path."""

    file: str = declared(
        "path, relative to robot.yaml or in the files of the package, or package://name/path", ""
    )
    package: str = declared("installed Python package; left out = none", "")
    description: str = declared(
        "instead of a file: a name of robot_descriptions whose data are in the user's cache", ""
    )
    root: str = declared("link that becomes the base", "")
    locked: tuple[str, ...] = declared("joints that stay at zero", ())
    frames: Mapping[str, FramePlace] = declared("name: place of a further frame", dict)

    def __post_init__(self) -> None:
        """Raise InvalidField unless one of file and description is given."""
        if bool(self.file) == bool(self.description):
            raise InvalidField("file", "a file or a description expected, one of both")


def find_urdf(entry: object, robot_file: Path) -> Path:
    """Path of the URDF named by the field `urdf` of a robot.yaml, with its changes applied.

    Raises:
        ConfigurationError: one line that says what was given, or which package is missing and
            how to get it. Whether a file next to robot.yaml exists is not checked here.
        UnknownName: a link or joint to be changed that is not in the URDF.
    """
    given = _read(entry, robot_file)
    urdf = _model_file(given, robot_file)
    frames = {name: (at.link, np.array(at.position)) for name, at in given.frames.items()}
    return UrdfChanges(given.root, given.locked, frames).write(urdf)


def _model_file(given: UrdfFields, robot_file: Path) -> Path:
    if given.description:
        try:
            return described_model(given.description)
        except ConfigurationError as error:
            raise ConfigurationError(f"{robot_file}: urdf: {error}") from error
    if given.package:
        return _in_package(given.package, given.file, robot_file)
    return resource_path(given.file, robot_file)


def package_of(entry: object, robot_file: Path) -> str:
    """Name of the Python package that a URDF comes with; empty for one next to robot.yaml.

    Raises:
        ConfigurationError: the field is neither a path nor such a section.
    """
    return _read(entry, robot_file).package


def _read(entry: object, robot_file: Path) -> UrdfFields:
    """The field `urdf`: a section, or the path alone."""
    if isinstance(entry, str) and entry:
        return UrdfFields(entry)
    if isinstance(entry, Mapping):
        return read(Fields(entry, robot_file, "urdf"), UrdfFields)
    raise ConfigurationError(
        f"{robot_file}: urdf: the path of a file, or {{package: name, file: path}} expected,"
        f" {entry!r} given"
    )


def _in_package(package: str, file: str, robot_file: Path) -> Path:
    try:
        files = distribution(package).files or []
    except PackageNotFoundError as error:
        raise ConfigurationError(
            f"{robot_file}: urdf: the robot's model comes with the Python package '{package}',"
            f" which is not installed: `make run` installs it, or `pip install {package}`"
        ) from error
    wanted = PurePosixPath(file).parts
    for entry in files:
        if entry.parts[-len(wanted) :] == wanted:
            return Path(str(entry.locate())).resolve()
    raise ConfigurationError(
        f"{robot_file}: urdf: the installed package '{package}' has no file '{file}'"
    )
