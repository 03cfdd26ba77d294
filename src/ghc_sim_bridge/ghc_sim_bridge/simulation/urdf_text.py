"""A URDF as MuJoCo has to read it: settings inside, a base that floats, shapes that are found.

MuJoCo knows no `package://` and would fuse a root link into the world, so the text is changed
before it is parsed; the robot's joints, masses and frames stay as they are.
"""

from __future__ import annotations

from xml.etree import ElementTree

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.urdf import resource_path
from ghc_sim_bridge.scene.values import SceneDescription

ROOT_JOINT = "floating_base"
WORLD_LINK = "world_below_the_base"

# Compiler settings have to be there when the URDF is read. Static bodies are fused only later,
# after their frames became sites.
_COMPILER = {
    "fusestatic": "false",
    "discardvisual": "false",
    "balanceinertia": "false",
    "boundmass": "0",
    "boundinertia": "0",
    "strippath": "false",
}


def prepare_urdf(text: str, scene: SceneDescription, shapes: bool) -> str:
    """Text for MuJoCo of the scene's URDF; without shapes no mesh has to be read.

    Raises:
        ConfigurationError: the text is no URDF; names the file.
    """
    try:
        robot = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise ConfigurationError(f"{scene.urdf}: not a URDF: {error}") from error
    if robot.tag != "robot":
        raise ConfigurationError(f"{scene.urdf}: not a URDF, it has no <robot> element")
    for link in robot.iter("link"):
        _choose_shapes(link, shapes)
    for mesh in robot.iter("mesh"):
        mesh.set("filename", str(resource_path(mesh.get("filename", ""), scene.urdf)))
    if scene.base is not None:
        _let_float(robot, root_link(robot))
    settings = ElementTree.Element("mujoco")
    ElementTree.SubElement(settings, "compiler", _COMPILER)
    robot.insert(0, settings)
    return ElementTree.tostring(robot, encoding="unicode")


def root_link(robot: ElementTree.Element) -> str:
    """Name of the link that is no joint's child: the base. Empty when there is none."""
    children = {child.get("link") for child in robot.iterfind("joint/child")}
    names = [link.get("name", "") for link in robot.iterfind("link")]
    return next((name for name in names if name not in children), "")


def _choose_shapes(link: ElementTree.Element, shapes: bool) -> None:
    """Keep what is to be seen: the visual shapes, or where there are none the collision ones."""
    visible = link.findall("visual") or link.findall("collision")
    for shape in [*link.findall("visual"), *link.findall("collision")]:
        if not shapes or shape not in visible:
            link.remove(shape)


def _let_float(robot: ElementTree.Element, base: str) -> None:
    ElementTree.SubElement(robot, "link", {"name": WORLD_LINK})
    joint = ElementTree.SubElement(robot, "joint", {"name": ROOT_JOINT, "type": "floating"})
    ElementTree.SubElement(joint, "parent", {"link": WORLD_LINK})
    ElementTree.SubElement(joint, "child", {"link": base})
