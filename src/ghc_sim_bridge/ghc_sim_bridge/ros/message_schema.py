"""A ROS message by its name: class, and definition as MCAP's `ros2msg` wants it."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pathlib import Path

from ament_index_python.packages import PackageNotFoundError, get_package_share_directory

from ghc_controller.errors import ConfigurationError

_SEPARATOR = "=" * 80
_INTEGERS = frozenset(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))
_PRIMITIVES = _INTEGERS | {"bool", "byte", "char", "float32", "float64", "string", "wstring"}


def message_schema(type_name: str) -> str:
    """Concatenated .msg text of `type_name`, such as "sensor_msgs/msg/JointState".

    Raises:
        ConfigurationError: the package or its .msg file is not installed, or the name is none.
    """
    package, name = _parts(type_name)
    parts = [_definition(package, name)]
    seen = {(package, name)}
    open_ = _dependencies(package, name)
    while open_:
        inner = open_.pop(0)
        if inner in seen:
            continue
        seen.add(inner)
        parts.append(f"{_SEPARATOR}\nMSG: {inner[0]}/{inner[1]}\n{_definition(*inner)}")
        open_.extend(_dependencies(*inner))
    return "\n".join(parts)


def message_class(type_name: str) -> type:
    """Class of `type_name`, such as "sensor_msgs/msg/JointState".

    Raises:
        ConfigurationError: the package is not installed, or has no such message, or the name is
            none.
    """
    package, name = _parts(type_name)
    try:
        found: type = getattr(import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError) as error:
        raise ConfigurationError(f"message type '{type_name}': {error}") from error
    return found


def _parts(type_name: str) -> tuple[str, str]:
    """Package and name of a type; one of a participant without ROS may have any name."""
    package, _, name = type_name.split("/") if type_name.count("/") == 2 else ("", "", "")
    if not (package.isidentifier() and name.isidentifier()):
        raise ConfigurationError(
            f"message type '{type_name}': a name such as 'sensor_msgs/msg/JointState' expected"
        )
    return package, name


def same_layout(one: str, other: str) -> bool:
    """Whether two definitions have the same fields; comments and blank lines do not count."""
    return _fields(one) == _fields(other)


def _fields(schema: str) -> list[str]:
    lines = (" ".join(line.partition("#")[0].split()) for line in schema.splitlines())
    return [line for line in lines if line]


@cache
def _definition(package: str, name: str) -> str:
    try:
        share = Path(get_package_share_directory(package))
        return (share / "msg" / f"{name}.msg").read_text(encoding="utf-8")
    except (PackageNotFoundError, OSError) as error:
        raise ConfigurationError(f"message type '{package}/msg/{name}': {error}") from error


def _dependencies(package: str, name: str) -> list[tuple[str, str]]:
    """(package, name) of the fields that are messages themselves, in their order."""
    found = []
    for line in _definition(package, name).splitlines():
        words = line.partition("#")[0].split()
        if not words or (len(words) > 1 and words[1].startswith("=")):
            continue
        kind = words[0].partition("[")[0].partition("<")[0]
        if kind in _PRIMITIVES or "=" in kind:
            continue
        scope, _, inner = kind.rpartition("/")
        found.append((scope.partition("/")[0] or package, inner))
    return found
