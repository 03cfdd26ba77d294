"""A URDF as MuJoCo has to read it: settings inside, a base that floats, shapes that are found.

MuJoCo knows no `package://` and would fuse a root link into the world, so the text is changed
before it is parsed; the robot's joints, masses and frames stay as they are.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, tostring

from ghc_controller.robot.urdf_text import parse_urdf, place_meshes, root_link

ROOT_JOINT = "floating_base"
WORLD_LINK = "world_below_the_base"
_MESHES = (".stl", ".obj", ".msh")  # formats that MuJoCo reads

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


def for_mujoco(urdf: Path, floating_base: bool, shapes: bool) -> str:
    """Text for MuJoCo of a URDF; without shapes no mesh has to be read.

    Raises:
        ConfigurationError: the file is no URDF; names it.
    """
    robot = parse_urdf(urdf)
    for link in robot.iter("link"):
        _choose_shapes(link, shapes)
    place_meshes(robot, urdf)
    if floating_base:
        _let_float(robot, root_link(robot))
    settings = Element("mujoco")
    SubElement(settings, "compiler", _COMPILER)
    robot.insert(0, settings)
    return tostring(robot, encoding="unicode")


def _choose_shapes(link: Element, shapes: bool) -> None:
    """Keep what is to be seen: the visual shapes, or where there are none the collision ones.

    Meshes in other formats, such as Collada, are none: MuJoCo would reject the robot.
    """
    visual, collision = link.findall("visual"), link.findall("collision")
    visible = list(filter(_is_readable, visual)) or list(filter(_is_readable, collision))
    for shape in [*visual, *collision]:
        if not shapes or shape not in visible:
            link.remove(shape)


def _is_readable(shape: Element) -> bool:
    names = (mesh.get("filename", "") for mesh in shape.iter("mesh"))
    return all(Path(name).suffix.lower() in _MESHES for name in names)


def _let_float(robot: Element, base: str) -> None:
    SubElement(robot, "link", {"name": WORLD_LINK})
    joint = SubElement(robot, "joint", {"name": ROOT_JOINT, "type": "floating"})
    SubElement(joint, "parent", {"link": WORLD_LINK})
    SubElement(joint, "child", {"link": base})
