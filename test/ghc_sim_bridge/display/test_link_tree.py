"""Transforms of a URDF against Pinocchio: every kind of joint, mimic joints among them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.library import load_robot
from ghc_sim_bridge.display.description import description_of
from ghc_sim_bridge.display.link_tree import LinkTree, Transform

HAND = """<robot name="hand">
  <link name="base"/><link name="wheel"/><link name="palm"/><link name="left"/><link name="right"/>
  <link name="tip"/><link name="far"/>
  <joint name="turn" type="continuous">
    <origin xyz="0.1 0.2 0.3" rpy="0.4 -0.5 0.6"/><axis xyz="1 2 -2"/>
    <parent link="base"/><child link="wheel"/>
  </joint>
  <joint name="mount" type="fixed">
    <origin xyz="0 0 0.1" rpy="3 0.2 -1"/><parent link="wheel"/><child link="palm"/>
  </joint>
  <joint name="finger" type="prismatic">
    <origin xyz="0 0.01 0" rpy="0.3 0 0"/><axis xyz="0 3 4"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
    <parent link="palm"/><child link="left"/>
  </joint>
  <joint name="other" type="prismatic">
    <axis xyz="0 -1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    <mimic joint="finger" multiplier="-0.5" offset="0.02"/>
    <parent link="palm"/><child link="right"/>
  </joint>
  <joint name="last" type="revolute">
    <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="other" multiplier="2"/>
    <parent link="right"/><child link="tip"/>
  </joint>
  <joint name="drop" type="fixed"><parent link="tip"/><child link="far"/></joint>
</robot>"""


def placed(transforms: list[Transform], root: str) -> dict[str, pin.SE3]:
    """Link -> placement in the root."""
    parents = {entry.child: entry for entry in transforms}
    found = {root: pin.SE3.Identity()}

    def place(link: str) -> pin.SE3:
        if link not in found:
            entry = parents[link]
            own = pin.SE3(pin.Quaternion(entry.quaternion), entry.translation)
            found[link] = place(entry.parent) * own
        return found[link]

    for link in parents:
        place(link)
    return found


def test_mimic_and_continuous_joints_agree_with_pinocchio() -> None:
    tree = LinkTree(HAND, "hand")
    assert tree.root == "base"
    assert tree.joints == ("turn", "finger")
    model = pin.buildModelFromXML(HAND)
    data = model.createData()
    random = np.random.default_rng(7)
    for _ in range(20):
        turn, finger = random.uniform(-9.0, 9.0), random.uniform(-1.0, 1.0)
        other = -0.5 * finger + 0.02
        values = {"turn": [np.cos(turn), np.sin(turn)], "finger": [finger]}
        values |= {"other": [other], "last": [2.0 * other]}
        q = np.concatenate([values[name] for name in list(model.names)[1:]])
        pin.framesForwardKinematics(model, data, q)
        links = placed([*tree.fixed, *tree.moving({"turn": turn, "finger": finger})], tree.root)
        assert len(links) == 7
        for link, place in links.items():
            expected = data.oMf[model.getFrameId(link, pin.FrameType.BODY)]
            assert np.abs(place.homogeneous - expected.homogeneous).max() < 1e-12


@pytest.mark.parametrize("name", ["kuka_lwr", "icub", "icub_fencer"])
def test_robots_agree_with_pinocchio(name: str) -> None:
    robot = load_robot(name)
    tree = LinkTree(description_of(robot.urdf), name)
    assert set(robot.model.joint_names) == set(tree.joints)
    model = pin.buildModelFromUrdf(str(robot.urdf))
    data = model.createData()
    random = np.random.default_rng(11)
    for _ in range(3):
        q = random.uniform(-1.5, 1.5, model.nq)
        pin.framesForwardKinematics(model, data, q)
        positions = dict(zip(list(model.names)[1:], q, strict=True))
        links = placed([*tree.fixed, *tree.moving(positions)], tree.root)
        assert set(robot.model.frame_names) <= set(links)
        for link, place in links.items():
            expected = data.oMf[model.getFrameId(link, pin.FrameType.BODY)]
            assert np.abs(place.homogeneous - expected.homogeneous).max() < 1e-9


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("<robot", "<<robot", "cannot be read as XML"),
        ('type="continuous"', 'type="planar"', "joint 'turn' is of type 'planar'"),
        ('xyz="1 2 -2"', 'xyz="0 0 0"', "joint 'turn': axis of length 0"),
        ('mimic joint="finger"', 'mimic joint="last"', "mimic joints follow each other"),
        ('<link name="base"/>', '<link name="base"/><link name="extra"/>', "base, extra"),
    ],
)
def test_what_cannot_be_drawn_is_one_clear_line(old: str, new: str, words: str) -> None:
    with pytest.raises(ConfigurationError, match=words):
        LinkTree(HAND.replace(old, new), "hand")


def test_a_description_names_its_meshes_as_files(tmp_path: Path) -> None:
    urdf = tmp_path / "arm.urdf"
    (tmp_path / "link.stl").touch()
    visual = '<visual><geometry><mesh filename="{}"/></geometry></visual>'
    names = ("link.stl", f"package://{tmp_path.name}/link.stl", "https://host/link.stl")
    urdf.write_text(
        f'<robot name="arm"><link name="base">{"".join(map(visual.format, names))}</link></robot>',
        encoding="utf-8",
    )
    text = description_of(urdf)
    assert text.count(f'filename="{(tmp_path / "link.stl").as_uri()}"') == 2
    assert 'filename="https://host/link.stl"' in text
