"""Paths from files: what is read, and what a wrong file is told."""

from __future__ import annotations

from pathlib import Path

import pytest

from ghc_controller.errors import ConfigurationError
from ghc_controller.references.point_files import Point, Points, read_points


def _file(folder: Path, name: str, text: str) -> Path:
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file


def test_csv_columns_go_by_their_names(tmp_path: Path) -> None:
    text = "time, x, velocity_x, y, velocity_y\n0, 1, 0.1, 2, 0.2\n\n1.5, 3, 0.3, 4, 0.4\n"
    assert read_points(_file(tmp_path, "path.csv", text)) == Points(
        (Point(0.0, (1.0, 2.0), (0.1, 0.2)), Point(1.5, (3.0, 4.0), (0.3, 0.4)))
    )


def test_csv_columns_may_stand_in_any_order(tmp_path: Path) -> None:
    """As those of a quaternion that others write with w first."""
    text = "velocity_z,qw,qx,qy,qz,z,y,x,velocity_x,velocity_y,time\n3,0.9,1,2,3,6,5,4,1,2,0\n"
    (point,) = read_points(_file(tmp_path, "path.csv", text)).points
    assert point == Point(0.0, (4.0, 5.0, 6.0, 1.0, 2.0, 3.0, 0.9), (1.0, 2.0, 3.0))
    text = "time,b,a,wrench_a,wrench_b\n0,2,1,10,20\n"
    points = read_points(_file(tmp_path, "path.csv", text))
    assert points == Points((Point(0.0, (2.0, 1.0), wrench=(20.0, 10.0)),), ("b", "a"))


@pytest.mark.parametrize("double", ["x", "time", "velocity_x"])
def test_a_column_that_is_given_twice_is_refused(tmp_path: Path, double: str) -> None:
    file = _file(tmp_path, "path.csv", f"time,x,velocity_x,{double}\n0,1,2,3\n")
    with pytest.raises(ConfigurationError, match=f"column '{double}' given twice"):
        read_points(file)


def test_other_columns_of_positions_are_joints(tmp_path: Path) -> None:
    points = read_points(_file(tmp_path, "path.csv", "time,joint_2,joint_1\n0,0.2,0.1\n"))
    assert points == Points((Point(0.0, (0.2, 0.1)),), ("joint_2", "joint_1"))


def test_yaml_holds_points_and_joints(tmp_path: Path) -> None:
    text = """
joints: [a, b]
points:
  - {time: 0.5, position: [1, 2]}
  - {time: 1.0, position: [3, 4], velocity: [0, 0], acceleration: [0, 0], wrench: [5, 6]}
"""
    points = read_points(_file(tmp_path, "path.yaml", text))
    assert points.joints == ("a", "b")
    assert points.end == 1.0
    assert points.points[1] == Point(1.0, (3.0, 4.0), (0.0, 0.0), (0.0, 0.0), (5.0, 6.0))


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("path.txt", "", "a .csv, .yaml or .yml file expected"),
        ("path.csv", "", "a first line with the names of the columns expected"),
        ("path.csv", "x,y\n1,2\n", "`time` among them"),
        ("path.csv", "time,x\n", "no points given"),
        ("path.csv", "time,x\n0,1,2\n", "line 2: 3 columns given, 2 expected"),
        ("path.csv", "time,x\n0,here\n", "line 2: could not convert string to float: 'here'"),
        ("path.csv", "time,x\n1,0\n1,0\n", "increasing times from 0 s on expected, 1 s given"),
        ("path.csv", "time,x\nnan,0\n", "increasing times from 0 s on expected"),
        ("path.yaml", "points: []\n", "points"),
        ("path.yaml", "points: [{time: 0, place: [1]}]\n", "place"),
        ("path.yaml", "points: [{time: -1, position: [1]}]\n", "time"),
    ],
)
def test_a_wrong_file_is_one_clear_line(tmp_path: Path, name: str, text: str, words: str) -> None:
    file = _file(tmp_path, name, text)
    with pytest.raises(ConfigurationError) as error:
        read_points(file)
    assert str(file) in str(error.value)
    assert words in str(error.value)
