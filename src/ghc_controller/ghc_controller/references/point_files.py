"""Reads reference points from CSV or YAML files, for the command `reference`.

```csv
time,x,y,z,velocity_x,velocity_y,velocity_z
0.0,0.50,0.1,0.7,0,0,0
2.0,0.55,0.1,0.7,0,0,0
```
`time` is in [s]. Columns that begin with velocity_, acceleration_ or wrench_ are derivatives and
wrenches; all others are positions: x, y, z, qx, qy, qz, qw, or the joints of a posture task.
Columns are matched by name, in any order: derivatives by the names of the positions or by x, y,
z, rx, ry, rz. Columns with other names keep the order of the task's rows.

```yaml
joints: [joint_1, joint_2]        # posture tasks only
points:
  - {time: 0.0, position: [0.1, 0.2], velocity: [0, 0], acceleration: [0, 0], wrench: []}
```
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ghc_controller.errors import ConfigurationError
from ghc_controller.schema.reader import Fields, read_yaml

Row = tuple[float, ...]

_DERIVED = ("velocity", "acceleration", "wrench")
_COORDINATES = ("x", "y", "z", "qx", "qy", "qz", "qw")
_RATES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class Point:
    """One point of a reference; the controller fills empty rows."""

    time: float  # [s] after the start
    position: Row = ()  # [m], [rad] or a unit quaternion x, y, z, w; empty = current position
    velocity: Row = ()  # [m/s], [rad/s]
    acceleration: Row = ()  # [m/s^2], [rad/s^2]
    wrench: Row = ()  # [N], [Nm] on the environment


@dataclass(frozen=True)
class Points:
    """Points by increasing time; sizes and values are not checked here."""

    points: tuple[Point, ...]
    joints: tuple[str, ...] = ()  # of the positions of a posture task

    @property
    def end(self) -> float:
        """[s] of the last point after the start."""
        return self.points[-1].time


def read_points(file: Path) -> Points:
    """Points of a .csv, .yaml or .yml file.

    Raises:
        ConfigurationError: names the file, the row or field, what was given and expected.
    """
    if file.suffix in (".yaml", ".yml"):
        return _from_yaml(file)
    if file.suffix == ".csv":
        return _from_csv(file)
    raise ConfigurationError(f"{file}: a .csv, .yaml or .yml file expected")


def _from_yaml(file: Path) -> Points:
    fields = read_yaml(file)
    points = tuple(_point(entry) for entry in fields.sections("points"))
    joints = fields.names("joints", optional=True, of="joints")
    fields.done()
    return _checked(Points(points, joints), file)


def _point(entry: Fields) -> Point:
    rows = {
        name: entry.vector(name, default=()) for name in ("position", *_DERIVED) if entry.has(name)
    }
    point = Point(entry.number("time", minimum=0.0), **rows)
    entry.done()
    return point


def _from_csv(file: Path) -> Points:
    try:
        with file.open(encoding="utf-8", newline="") as stream:
            rows = [row for row in csv.reader(stream, skipinitialspace=True) if any(row)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ConfigurationError(f"{file}: cannot be read: {error}") from error
    names = [name.strip() for name in rows[0]] if rows else []
    if "time" not in names:
        raise ConfigurationError(
            f"{file}: a first line with the names of the columns expected, `time` among them"
        )
    for name in names:
        if names.count(name) > 1:
            raise ConfigurationError(f"{file}: column '{name}' given twice, each once expected")
    columns = _columns(names)
    points = tuple(
        Point(**{name: _values(row, places) for name, places in columns.items()}, time=time)
        for row, time in ((row, row[names.index("time")]) for row in _numbers(rows, file))
    )
    others = [names[place] for place in columns["position"]]
    joints = () if set(others) <= set(_COORDINATES) else tuple(others)
    return _checked(Points(points, joints), file)


def _columns(names: Sequence[str]) -> Mapping[str, list[int]]:
    """Field of a point -> indices of its columns, in the order of the task's rows."""
    found: dict[str, dict[str, int]] = {"position": {}}
    for place, name in enumerate(names):
        kind, _, row = name.partition("_")
        if name != "time":
            field, row = (kind, row) if kind in _DERIVED else ("position", name)
            found.setdefault(field, {})[row] = place
    positions = _ordered(found["position"], _COORDINATES)
    return {
        field: list(_ordered(_ordered(places, tuple(positions)), _RATES).values())
        if field in _DERIVED
        else list(positions.values())
        for field, places in found.items()
    }


def _ordered(places: Mapping[str, int], order: Sequence[str]) -> dict[str, int]:
    """Column indices by row, in the given order; unchanged if there are other rows."""
    if not set(places) <= set(order):
        return dict(places)
    return {row: places[row] for row in order if row in places}


def _values(row: Row, places: Sequence[int]) -> Row:
    return tuple(row[place] for place in places)


def _numbers(rows: Sequence[Sequence[str]], file: Path) -> list[Row]:
    """All lines after the header as numbers."""
    result = []
    for number, row in enumerate(rows[1:], start=2):
        if len(row) != len(rows[0]):
            raise ConfigurationError(
                f"{file}: line {number}: {len(row)} columns given, {len(rows[0])} expected"
            )
        try:
            result.append(tuple(float(cell) for cell in row))
        except ValueError as error:
            raise ConfigurationError(f"{file}: line {number}: {error}") from error
    return result


def _checked(points: Points, file: Path) -> Points:
    if not points.points:
        raise ConfigurationError(f"{file}: no points given, at least one expected")
    times = [point.time for point in points.points]
    for before, after in zip([-1.0, *times], times, strict=False):
        if not (after >= 0.0 and after > before):
            raise ConfigurationError(
                f"{file}: increasing times from 0 s on expected, {after:g} s given"
                + (f" after {before:g} s" if before >= 0.0 else "")
            )
    return points
