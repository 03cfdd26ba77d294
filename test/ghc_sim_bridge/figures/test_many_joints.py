"""Figures of a robot of ten joints, two of which slide: all named, distinguished, in their
units."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from made_up_run import made_up
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Annotation

from ghc_sim_bridge.colors import PALETTE, color, dashes, rgb, rgba
from ghc_sim_bridge.figures import animation
from ghc_sim_bridge.figures.motion import joints_by_kind, joints_figure
from ghc_sim_bridge.figures.tasks import tasks_figure
from ghc_sim_bridge.viewer.layout import colours

NAMES = ("rail", "lift", *(f"shoulder_arm_joint_{k}" for k in range(1, 9)))
SLIDING = NAMES[:2]


def robot_of_ten(folder: Path) -> Path:
    """robot.yaml of a chain of ten joints; the tasks are those of the KUKA's scenarios."""
    links, joints = ['<link name="link_0"/>'], []
    for k, name in enumerate(NAMES, start=1):
        kind, axis = ("prismatic", "1 0 0") if name in SLIDING else ("revolute", f"0 {k % 2} 1")
        links.append(
            f'<link name="link_{k}"><inertial><mass value="1"/>'
            '<inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        )
        joints.append(
            f'<joint name="{name}" type="{kind}"><origin xyz="0 0 0.1"/><axis xyz="{axis}"/>'
            f'<parent link="link_{k - 1}"/><child link="link_{k}"/>'
            '<limit lower="-3" upper="3" effort="50" velocity="2"/></joint>'
        )
    text = f'<robot name="ten">{"".join(links + joints)}</robot>'
    (folder / "ten.urdf").write_text(text, encoding="utf-8")
    file = folder / "robot.yaml"
    file.write_text(
        """
name: ten
urdf: ten.urdf
tasks:
  - {name: end_effector, kind: frame_position, frame: link_10, stiffness: 30, damping: 20}
  - {name: elbow, kind: frame_position, frame: link_5, stiffness: 30, damping: 20}
  - {name: rest, kind: posture, stiffness: 30, damping: 20}
hierarchy: end_effector > elbow > rest
""",
        encoding="utf-8",
    )
    return file


@pytest.fixture
def figure(tmp_path: Path) -> Figure:
    analysis, _ = made_up(tmp_path, "insertion_removal", NAMES, robot_of_ten(tmp_path))
    turning, sliding = joints_by_kind(analysis)
    assert [NAMES[place] for place in sliding] == list(SLIDING)
    assert len(turning) == 8
    drawn = joints_figure(analysis)
    FigureCanvasAgg(drawn).draw()
    return drawn


def test_every_joint_is_named_once_with_a_look_of_its_own(figure: Figure) -> None:
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == list(NAMES)
    looks = [(line.get_color(), line.get_linestyle()) for line in legend.get_lines()]
    assert len(set(looks)) == len(NAMES)


def test_joints_that_slide_are_in_their_own_units(figure: Figure) -> None:
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == [
        "joint velocity [rad/s]",
        "joint velocity [m/s]",
        "joint torque [Nm]",
        "joint force [N]",
        "largest torque rate\n[Nm/s or N/s] at 1 ms",
    ]
    counts = [
        len([line for line in axes.lines if len(line.get_xdata()) > 2]) for axes in figure.axes
    ]
    assert counts == [8, 2, 8, 2, 1]


def test_no_text_overprints_another(figure: Figure) -> None:
    renderer = FigureCanvasAgg(figure).get_renderer()
    (legend,) = figure.legends
    boxes = {"legend": legend.get_window_extent(renderer)}
    (title,) = figure.texts
    boxes["title"] = title.get_window_extent(renderer)
    for number, axes in enumerate(figure.axes):
        boxes[f"label {number}"] = axes.yaxis.label.get_window_extent(renderer)
        boxes[f"axes {number}"] = axes.get_window_extent(renderer)
        for note in axes.texts:
            assert isinstance(note, Annotation)
            if note.get_text() != "rate limit":  # stands in its axes
                boxes[f"note {number} {note.get_text()}"] = note.get_window_extent(renderer)
    for (one, first), (other, second) in combinations(boxes.items(), 2):
        assert not first.overlaps(second), f"{one} and {other}"
    width, height = figure.get_size_inches() * figure.dpi
    for name, box in boxes.items():
        assert box.x0 >= 0.0 and box.y0 >= 0.0 and box.x1 <= width and box.y1 <= height, name


def test_a_task_has_one_color_in_figures_animations_and_viewers(tmp_path: Path) -> None:
    analysis, trace = made_up(tmp_path, "insertion_removal")
    drawn = tasks_figure(analysis, trace)
    logarithmic = (
        drawn.axes[-2] if drawn.axes[-1].get_ylabel().endswith("[rad]") else drawn.axes[-1]
    )
    lines = [line for line in logarithmic.lines if str(line.get_label())[:1].isdigit()]
    assert len(lines) == 3
    markers = animation._targets(analysis, 1.0)
    for index, line in enumerate(lines):
        expected = to_rgb(color(index))
        assert to_rgb(line.get_color()) == expected
        assert rgb(index) == tuple(colours(12)[index])
        assert np.array(rgb(index)) / 255.0 == pytest.approx(expected)
        if index < len(markers):
            assert markers[index].colour == pytest.approx((*expected, 1.0))
            assert markers[index].colour == pytest.approx(rgba(color(index)))


def test_the_palette_is_told_apart_on_light_and_on_dark_ground() -> None:
    colors = np.array([rgb(index) for index in range(len(PALETTE))], dtype=float)
    assert len({color(index) for index in range(12)}) == 12
    for one, other in combinations(colors, 2):
        assert np.linalg.norm(one - other) > 45.0
    luminance = colors @ [0.2126, 0.7152, 0.0722]
    assert luminance.min() > 35.0 and luminance.max() < 200.0
    looks = {(color(index), dashes(index)) for index in range(48)}
    assert len(looks) == 48
