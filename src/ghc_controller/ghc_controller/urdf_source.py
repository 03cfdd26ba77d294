"""Where a robot's URDF is: beside its robot.yaml, or in an installed Python package.

```yaml
urdf: my_arm.urdf                                   # relative to robot.yaml
urdf: {package: my-models, file: share/my/arm.urdf} # in the files of a Python package
urdf: {package: .., file: .., fixed_joints: [neck]} # with some joints fixed at zero
```
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path, PurePosixPath

from ghc_controller.errors import ConfigurationError
from ghc_controller.urdf_variant import with_fixed_joints

PACKAGE_SCHEME = "package://"


def find_urdf(entry: object, robot_file: Path) -> Path:
    """Path of the URDF that the field `urdf` of a robot.yaml names.

    Raises:
        ConfigurationError: one line that says what was given, or which package is missing and
            how to get it. Whether a file beside robot.yaml exists is left to whoever opens it.
        UnknownName: a joint to be fixed that the URDF does not have.
    """
    package, file, fixed = _read(entry, robot_file)
    if not package:
        return robot_file.parent / file
    urdf = _in_package(package, file, robot_file)
    return with_fixed_joints(urdf, fixed, resource_path) if fixed else urdf


def package_of(entry: object, robot_file: Path) -> str:
    """Name of the Python package that a URDF comes with; empty for one beside robot.yaml.

    Raises:
        ConfigurationError: the field is neither a path nor package and file.
    """
    return _read(entry, robot_file)[0]


def _read(entry: object, robot_file: Path) -> tuple[str, str, tuple[str, ...]]:
    """Package, empty for none, file, and joints to be fixed."""
    if isinstance(entry, str) and entry:
        return "", entry, ()
    if isinstance(entry, Mapping) and set(entry) - {"fixed_joints"} == {"package", "file"}:
        package, file, fixed = entry["package"], entry["file"], entry.get("fixed_joints", [])
        texts = [package, file, *(fixed if isinstance(fixed, list) else [None])]
        if all(isinstance(text, str) and text for text in texts):
            return package, file, tuple(fixed)
    raise ConfigurationError(
        f"{robot_file}: urdf: the path of a file, or {{package: name, file: path}} expected,"
        f" {entry!r} given"
    )


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
