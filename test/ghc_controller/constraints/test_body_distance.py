"""Distances of bodies as a constraint: which pairs, how rows come and go, and arms that meet."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.constraints import Tick
from ghc_controller.constraints.bodies.activation import relaxation
from ghc_controller.constraints.bodies.collection import Body
from ghc_controller.constraints.registry import make_constraint
from ghc_controller.constraints.rows.body_distance import BodyDistance
from ghc_controller.errors import ConfigurationError, InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.model.rounded_shape import Shape
from ghc_controller.previews.preview import BODY_MARGINS, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.robot.library import load_robot
from ghc_controller.robot.link_bodies import enclosing_capsule
from ghc_controller.schema.reader import Fields
from ghc_controller.types import Array, RobotState
from ghc_sim_bridge.simulation.simulator import Simulator

DT = 1e-3  # [s]


def _constraint(**entry: Any) -> tuple[BodyDistance, RobotModel]:
    """On the arm: three bodies along it, with a ball in the world."""
    model = load_robot("kuka_lwr").model
    given = {
        "name": "bodies",
        "kind": "body_distance",
        "bodies": {
            "upper": {"frame": "link_2", "from": [0, 0, 0], "to": [0, 0, 0.19], "radius": 0.08},
            "fore": {"frame": "link_4", "from": [0, 0, 0], "to": [0, 0, 0.19], "radius": 0.08},
            "hand": {"frame": "tool", "at": [0, 0, 0], "radius": 0.05},
        },
        "obstacles": {"ball": {"at": [0.6, 0, 0.5], "radius": 0.1}},
        "margins": {"all": {"margin": 0.02}},
    }
    made = make_constraint(Fields(given | entry, "robot.yaml"), model)
    assert isinstance(made, BodyDistance)
    return made, model


def _tick(model: RobotModel, q: Array, v: Array | None = None, time: float = 0.0) -> Tick:
    state = RobotState(time, q, np.zeros(model.nv) if v is None else v)
    return Tick(model, model.update(state.q, state.v), state, None, DT)


def test_neighbors_and_excluded_pairs_have_no_row() -> None:
    """One joint between two links: neighbors; two joints apart they are looked at."""
    assert _constraint()[0].pairs == [
        ("upper", "fore"),
        ("upper", "hand"),
        ("upper", "ball"),
        ("fore", "hand"),
        ("fore", "ball"),
        ("hand", "ball"),
    ]
    fewer = _constraint(excluded=[["upper", "*"]], margins={"a": {"pairs": "all", "margin": 0.0}})
    assert fewer[0].pairs == [("fore", "hand"), ("fore", "ball"), ("hand", "ball")]


def test_a_pair_has_the_margin_of_the_first_entry_that_names_it() -> None:
    margins = {"near": {"pairs": [["ball", "hand"]], "margin": 0.05}, "rest": {"margin": 0.01}}
    made, _ = _constraint(margins=margins)
    found = dict(zip(made.pairs, made.pair_margins(0.0).tolist(), strict=True))
    assert found[("hand", "ball")] == 0.05
    assert found[("upper", "fore")] == 0.01


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"bodies": {"a": {"frame": "tool", "radius": 0.1}}}, "'at' .sphere, box. or 'from'"),
        ({"bodies": {"a": {"frame": "nowhere", "at": [0, 0, 0], "radius": 0.1}}}, "nowhere"),
        ({"bodies": {"a": {"frame": "tool", "at": [0, 0, 0]}}}, "radius"),
        ({"margins": {"m": {"pairs": [["hand", "foot"]], "margin": 0.1}}}, "body 'foot'"),
        ({"margins": {"m": {"pairs": ["hand"], "margin": 0.1}}}, "pairs of names"),
        ({"obstacles": {"hand": {"at": [0, 0, 0], "radius": 0.1}}}, "already taken"),
        ({"margins": {}}, "no pair"),
    ],
)
def test_an_entry_that_makes_no_sense_is_rejected(entry: Mapping[str, Any], words: str) -> None:
    with pytest.raises(ConfigurationError, match=words):
        _constraint(**entry)


def test_what_overlaps_at_the_first_state_is_left_out_with_a_warning() -> None:
    """And looked at again after a reset to a state where it does not."""
    made, model = _constraint(obstacles={"ball": {"at": [0, 0, 0.5], "radius": 0.1}})
    with pytest.warns(UserWarning, match="upper-ball"):
        made.rows(_tick(model, np.zeros(7)))
    assert made.touching == (("upper", "ball"),)
    made.reset()
    made.rows(_tick(model, np.array([0.0, 1.5, 0, 0, 0, 0, 0])))
    assert not made.touching


@pytest.mark.parametrize("apart", [-3e-4, 3e-4, 0.02])
def test_a_hand_over_a_large_table_is_left_out_only_if_it_touches(apart: float) -> None:
    """The smooth distance is 0.6 mm smaller there than the true one."""
    model = load_robot("kuka_lwr").model
    tool, q = model.frame_id("tool"), np.array([0.3, 0.4, 0.1, 1.0, -0.4, -0.9, 0.2])
    model.update(q, np.zeros(7))
    center = model.frame_position(tool) - [0.0, 0.0, 0.05 + apart + 0.02]
    table = {"at": center.tolist(), "size": [1.6, 0.8, 0.04]}
    made, model = _constraint(
        obstacles={"table": table}, margins={"m": {"pairs": [["hand", "table"]], "margin": 0.0}}
    )
    if apart < 0.0:
        with pytest.warns(UserWarning, match="hand-table"):
            assert made.rows(_tick(model, q)) is None
        return
    rows = made.rows(_tick(model, q))
    assert rows is not None
    assert not made.touching
    assert made.distances()[0] == pytest.approx(apart, abs=1e-3)
    upwards = model.frame_jacobian(tool)[2]
    assert rows.matrix[0] == pytest.approx(upwards, rel=0.05, abs=0.01)


def test_rows_come_and_go_where_they_allow_everything() -> None:
    """Along a motion no bound steps: neither at the influence distance nor by rank."""
    made, model = _constraint(most=2)
    start, end = np.array([0.0, -1.5, 0, 1.0, 0, 0, 0]), np.array([0.5, 1.9, 0.3, 2.0, 0, 0, 0])
    lowers: list[dict[str, float]] = []
    for s in np.linspace(0.0, 1.0, 3001):
        rows = made.rows(_tick(model, start + s * (end - start)))
        bounds: dict[str, float] = {}
        for name, lower in zip(rows.names, rows.lower, strict=True) if rows else ():
            bounds[name] = max(bounds.get(name, -np.inf), float(lower))
        lowers.append(bounds)
    appeared = [b[name] for a, b in pairwise(lowers) for name in b.keys() - a.keys()]
    gone = [a[name] for a, b in pairwise(lowers) for name in a.keys() - b.keys()]
    assert appeared and gone
    assert max(appeared + gone) < -30.0  # [m/s^2] no row asks for more than 10
    assert relaxation(np.array([0.0, 0.1]), 0.2, np.inf) == pytest.approx([0.0, 0.0])


@pytest.mark.parametrize("count", [15, 17, 40])
def test_shapes_that_are_equally_near_all_have_their_row(count: int) -> None:
    """A link of many shapes flat over a table: more than `most`, and none may be left out."""
    model = load_robot("kuka_lwr").model
    tool = model.frame_id("tool")
    state = RobotState(0.0, np.array([0.3, 0.4, 0.1, 1.0, -0.4, -0.9, 0.2]), np.zeros(7))
    model.update(state.q, state.v)
    place, turn = model.frame_position(tool).copy(), model.frame_rotation(tool).T.copy()
    falling = np.linalg.pinv(model.frame_jacobian(tool)[:3]) @ np.array([0.0, 0.0, -0.3])
    flat = [turn @ np.array([0.01 * (k - 0.5 * count), 0.0, 0.0]) for k in range(count)]
    shapes = tuple(Shape(center, np.zeros((3, 0)), 0.02) for center in flat)
    table = Shape.box(place - [0.0, 0.0, 0.145], np.array([0.3, 0.3, 0.2]), np.eye(3))
    bodies = {"hand": Body("tool", shapes), "table": Body("", (table,))}
    made = BodyDistance("flat", model, bodies, {"all": ([("*", "*")], 0.015)})
    state = replace(state, v=falling)
    model.update(state.q, state.v)
    rows = made.rows(Tick(model, model.dynamics, state, None, DT))
    assert rows is not None
    assert len(rows.names) == count
    assert rows.lower.max() > 0.9 * made.brake


def _margins(made: BodyDistance, lower: Array, step: float = 0.01, **about: Any) -> Preview:
    shape, on = lower.reshape(1, -1), (True,)
    rows, status = about.get("rows", ("all",)), (PreviewStatus.SMOOTHED,)
    upper = np.full(shape.shape, 10.0)
    return Preview(BODY_MARGINS, 0.0, step, rows, shape, upper, on, status, (False,), True)


def test_a_margin_follows_a_preview_and_is_never_below_that_of_the_file() -> None:
    made, _ = _constraint()
    made.follow(_margins(made, np.linspace(0.0, 0.1, 11)))
    assert made.pair_margins(0.0)[0] == pytest.approx(0.02)
    assert made.pair_margins(0.05)[0] == pytest.approx(0.05)
    assert made.pair_margins(9.0)[0] == pytest.approx(0.1)
    unknown = made.follow(_margins(made, np.zeros(5), rows=("other",)))
    assert "margin 'other'" in str(unknown[0])
    made.reset()
    assert made.pair_margins(9.0)[0] == 0.02


def test_two_constraints_on_bodies_are_one_too_many() -> None:
    """Both would follow the same previews."""
    made, model = _constraint()
    other, _ = _constraint(name="more")
    with pytest.raises(InvalidValue, match="body_margins"):
        ghc.constraints.ConstraintSet([made, other], model)


def test_the_two_arms_are_the_arm_twice() -> None:
    one = ET.parse(load_robot("kuka_lwr").urdf).getroot()
    two = ET.parse(load_robot("two_arms").urdf).getroot()
    for side in ("left", "right"):
        for tag in ("link", "joint"):
            for part in one.findall(tag):
                name = f"{side}_{part.get('name')}"
                twin = next(other for other in two.findall(tag) if other.get("name") == name)
                for a, b in zip(part.iter(), twin.iter(), strict=True):
                    told = {key: value.removeprefix(f"{side}_") for key, value in b.attrib.items()}
                    assert (a.tag, dict(a.attrib)) == (b.tag, told)


def test_arms_that_want_the_same_place_keep_their_margin() -> None:
    """Both hands are sent to one point, and stay 3 cm apart; the judge is exact."""
    simulator = Simulator("two_arms", control_dt=DT)
    controller = ghc.Controller.for_robot("two_arms")
    controller.start(simulator.state())
    constraint = controller.constraints.one_of(BodyDistance)
    margins, least = constraint.pair_margins(0.0), np.inf
    for hand in ("left_hand", "right_hand"):
        controller.set_reference(hand, [0.5, 0.0, 0.5])
    for tick in range(1500):
        result = controller.step(simulator.state())
        assert result.status is not ghc.StepStatus.FALLBACK
        simulator.step(result.torque)
        if tick % 10 == 0:
            least = min(least, float((constraint.distances() - margins).min()))
    assert -1e-3 < least < 5e-3  # they met, and kept the margin
    assert any(
        name.startswith("bodies.left_hand") for name in controller.report().active_constraints
    )


_COLLISIONS = """
  <collision><origin xyz="0 0 0.1" rpy="0 1.5708 0"/>
    <geometry><cylinder radius="0.05" length="0.2"/></geometry></collision>
  <collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>
  <collision><origin xyz="0 0 0.2"/><geometry><sphere radius="0.07"/></geometry></collision>
"""


def test_collision_shapes_of_the_urdf_are_bodies(tmp_path: Path) -> None:
    """A cylinder becomes the capsule about it; box and sphere stay what they are."""
    text = load_robot("kuka_lwr").urdf.read_text(encoding="utf-8")
    urdf = tmp_path / "arm.urdf"
    for link in ("link_0", "link_7"):
        text = text.replace(f'<link name="{link}">', f'<link name="{link}">{_COLLISIONS}')
    urdf.write_text(text, encoding="utf-8")
    entry = {"name": "bodies", "kind": "body_distance", "links": ["link_*"]}
    robot = ghc.Robot.from_urdf(
        urdf,
        tasks=[ghc.posture("posture", stiffness=30.0, damping=20.0)],
        hierarchy="posture",
        constraints=[entry | {"margins": {"all": {"margin": 0.01}}}],
    )
    made = robot.constraints[0]
    assert isinstance(made, BodyDistance)
    assert made.pairs == [("link_0", "link_7")]
    shapes = made.bodies["link_7"].shapes
    assert [shape.axes.shape[1] for shape in shapes] == [1, 3, 0]
    assert shapes[0].axes[:, 0] == pytest.approx([0.1, 0.0, 0.0], abs=1e-5)
    assert np.isfinite(made.distances()).all()
    copied = next(c for c in ghc.Controller(robot).constraints.constraints if c.name == "bodies")
    assert isinstance(copied, BodyDistance)
    assert copied.pairs == made.pairs


def test_a_constraint_made_by_hand_sees_the_robot_of_its_controller() -> None:
    """The controller copies the robot with its model, and not this constraint."""
    robot = load_robot("kuka_lwr")
    ball = Shape(np.array([0.5, 0.0, 0.5]), np.zeros((3, 0)), 0.05)
    hand = Body("tool", (Shape(np.zeros(3), np.zeros((3, 0)), 0.05),))
    bodies, margins = {"hand": hand, "ball": Body("", (ball,))}, {"all": ([("*", "*")], 0.02)}
    made = BodyDistance("by_hand", robot.model, bodies, margins)
    controller = ghc.Controller(replace(robot, constraints=(made,), contacts=()))
    q = 0.4 * robot.model.position_upper
    controller.step(ghc.RobotState(0.0, q, np.zeros(robot.model.nv)))
    tool = controller.model.frame_position(controller.model.frame_id("tool"))
    assert made.distances()[0] == pytest.approx(np.linalg.norm(tool - ball.center) - 0.1, abs=1e-9)


def test_a_capsule_about_a_mesh_contains_it() -> None:
    rng = np.random.default_rng(6)
    for _ in range(20):
        points = rng.normal(size=(200, 3)) * rng.uniform(0.02, 0.3, 3) + rng.normal(size=3)
        shape = enclosing_capsule(points)
        axis = shape.axes[:, 0] if shape.axes.shape[1] else np.zeros(3)
        share = np.clip((points - shape.center) @ axis / max(float(axis @ axis), 1e-12), -1.0, 1.0)
        away = np.linalg.norm(points - shape.center - np.outer(share, axis), axis=1)
        assert away.max() <= shape.radius + 1e-9
