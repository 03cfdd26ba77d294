"""Mistakes in the files of a robot: robot.yaml, URDF, scene and scenario."""

from __future__ import annotations

import sys
from pathlib import Path
from unittest.mock import patch

from benchmarks.mistakes.arm import (
    ROBOT,
    SCENARIO,
    SCENE,
    URDF,
    edited,
    started,
    write_arm,
)
from benchmarks.mistakes.mistake import Doing, Mistake, refused
from ghc_controller.robot.robot import load_robot_config
from ghc_sim_bridge.programs.check_robot import find_faults
from ghc_sim_bridge.scenario.home import mark_home
from ghc_sim_bridge.scenario.plan import RunOptions
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import find_scenario, load_scenario

_WRIST = '<limit lower="-2.5" upper="2.5" effort="20" velocity="3.0"/>'
_JOINT = '<joint name="wrist" type="revolute">'
_WRIST_AXIS = """
    <parent link="middle"/><child link="lower"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    """
_CONTINUOUS, _FORCE = '<joint name="wrist" type="continuous">', '<limit effort="20" velocity="3"/>'
_XACRO = '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"/>'
_MJCF = """<mujoco><worldbody><body><joint type="hinj"/><geom size="0.1"/></body></worldbody>
</mujoco>"""
_MASS = """<inertial><origin xyz="0 0 0.1"/><mass value="1.0"/>
      <inertia ixx="0.005" iyy="0.005" izz="0.0005" ixy="0" ixz="0" iyz="0"/></inertial>"""


def _with_urdf(text: str, name: str) -> Doing:
    """The arm with another model file."""

    def do(folder: Path) -> str:
        write_arm(folder)
        (folder / name).write_text(text, encoding="utf-8")
        robot = folder / ROBOT
        changed = robot.read_text(encoding="utf-8").replace(URDF, name)
        robot.write_text(changed, encoding="utf-8")
        return started(folder)

    return do


def _mimic(folder: Path) -> str:
    """The wrist follows the elbow, and no file names it any more."""
    edited(URDF, _WRIST, f'{_WRIST}<mimic joint="elbow"/>')(folder)
    for file, old in ((ROBOT, "wrist: 2.0"), (SCENE, ", wrist: 0.5")):
        path = folder / file
        path.write_text(path.read_text(encoding="utf-8").replace(old, ""), encoding="utf-8")
    return started(folder)


def _xacro(folder: Path) -> str:
    """As on a machine without the package."""
    with patch.dict(sys.modules, {"xacro": None}):
        return _with_urdf(_XACRO, "robot.xacro")(folder)


def _missing_mesh(folder: Path) -> str:
    mesh = '<geometry><mesh filename="package://my_arm/lower.stl"/></geometry>'
    edited(URDF, '<geometry><cylinder radius="0.03" length="0.2"/></geometry>', mesh)(folder)
    return "; ".join(find_faults(load_robot_config(folder / ROBOT), None))


def _two_scenarios_of_one_name(folder: Path) -> str:
    """Both results are kept: the second one goes to a folder of another name."""
    homes = []
    for place in ("first", "second"):
        home = folder / place
        home.mkdir()
        write_arm(home)
        scenario = load_scenario(str(home / SCENARIO))
        plan = make_plan(scenario, RunOptions(), folder / "results")
        mark_home(scenario, plan.folder.parent)
        homes.append(plan.folder.parent)
    first, second = homes
    return "" if first == second else f"results in {first} and {second}"


FILES = (
    Mistake(
        1,
        "`stiffnes:` in robot.yaml",
        ("robot.yaml", "tasks[0].stiffness", "missing", "stiffnes,"),
        edited(ROBOT, "stiffness", "stiffnes"),
    ),
    Mistake(
        2,
        "a task without gains",
        ("robot.yaml", "tasks[0].stiffness", "missing"),
        edited(ROBOT, ", stiffness: 30.0, damping: 20.0", ""),
    ),
    Mistake(
        3,
        "a frame that the URDF lacks, `hnad`",
        ("robot.yaml", "'hnad'", "known: ", "hand"),
        edited(ROBOT, "frame: hand", "frame: hnad"),
    ),
    Mistake(
        4,
        "task kind `frame_positon`",
        ("robot.yaml", "'frame_positon'", "known: ", "frame_position"),
        edited(ROBOT, "kind: frame_position", "kind: frame_positon"),
    ),
    Mistake(
        5,
        "a limit of joint `wirst`",
        ("robot.yaml", "'wirst'", "known: ", "wrist"),
        edited(ROBOT, "{wrist: 2.0}", "{wirst: 2.0}"),
    ),
    Mistake(
        6,
        "a negative gain",
        ("robot.yaml", "stiffness", "-30", "given", "expected"),
        edited(ROBOT, "stiffness: 30.0", "stiffness: -30.0"),
    ),
    Mistake(
        7,
        "stiffness 30000 and damping 2000 at 1 ms",
        ("tasks[0].damping", "2000", "given", "expected", "control_dt"),
        edited(ROBOT, "stiffness: 30.0, damping: 20.0", "stiffness: 30000.0, damping: 2000.0"),
    ),
    Mistake(
        8,
        "`hierarchy: hand > postur`",
        ("robot.yaml", "hierarchy", "'postur'", "known: hand, posture"),
        edited(ROBOT, "hand > posture", "hand > postur"),
    ),
    Mistake(
        9,
        "`hierarchy: hand >> posture`",
        ("robot.yaml", "malformed hierarchy 'hand >> posture'", "'a > b = c'"),
        edited(ROBOT, "hand > posture", "hand >> posture"),
    ),
    Mistake(
        10,
        "a tab in a YAML file",
        ("robot.yaml", "not valid YAML", "line", "column"),
        edited(ROBOT, "limits:\n  velocity", "limits:\n\tvelocity"),
    ),
    Mistake(
        11,
        "a wrong path of the URDF",
        ("robot.yaml", "no_such.urdf", "does not exist"),
        edited(ROBOT, URDF, "no_such.urdf"),
    ),
    Mistake(
        12,
        "a URDF of a package that is not installed",
        ("robot.yaml", "'no_such_models'", "not installed", "pip install"),
        edited(ROBOT, URDF, "{package: no_such_models, file: arm.urdf}"),
    ),
    Mistake(
        13,
        "the reference of a posture in degrees (30, 45, 10)",
        ("robot.yaml", "tasks[1].reference", "'shoulder'", "30", "expected"),
        edited(ROBOT, "reference: 0.5", "reference: {shoulder: 30, elbow: 45, wrist: 10}"),
    ),
    Mistake(
        14,
        "`start` of a scene in degrees",
        ("scene.yaml", "start.shoulder", "20", "expected", "radians"),
        edited(SCENE, "{shoulder: 0.2,", "{shoulder: 20,"),
    ),
    Mistake(
        15,
        "a xacro file without the package that expands it",
        ("robot.xacro", "'xacro' is not installed", "pip install xacro", "expand it first"),
        _xacro,
    ),
    Mistake(
        16,
        "an MJCF file that MuJoCo does not compile",
        ("arm.xml", "MuJoCo", "hinj"),
        _with_urdf(_MJCF, "arm.xml"),
    ),
    Mistake(
        17,
        "a continuous joint",
        ("planar_arm.urdf", "continuous", "wrist", "may turn"),
        edited(URDF, f"{_JOINT}{_WRIST_AXIS}{_WRIST}", f"{_CONTINUOUS}{_WRIST_AXIS}{_FORCE}"),
    ),
    Mistake(
        18,
        "a revolute joint without `<limit>`",
        ("planar_arm.urdf", "'wrist'", "limit"),
        edited(URDF, _WRIST, ""),
    ),
    Mistake(
        19,
        'effort="0" velocity="0"',
        ("'wrist'", "gives 0", "positive limit expected", "robot.yaml"),
        edited(URDF, 'effort="20" velocity="3.0"', 'effort="0" velocity="0"'),
    ),
    Mistake(
        20,
        "a link without `<inertial>`",
        ("planar_arm.urdf", "'wrist'", "inertia"),
        edited(URDF, _MASS, ""),
    ),
    Mistake(
        21,
        "a mesh that does not exist (`check_robot`)",
        ("planar_arm.urdf", "package://my_arm/lower.stl", "does not exist"),
        _missing_mesh,
    ),
    Mistake(
        22,
        "a mimic joint",
        ("planar_arm.urdf", "mimic", "wrist", "held"),
        _mimic,
    ),
    Mistake(
        23,
        "`start` of joint `wirst`",
        ("scene.yaml", "start", "'wirst'", "known: ", "wrist"),
        edited(SCENE, "wrist:", "wirst:"),
    ),
    Mistake(
        24,
        "a scene without `camera`",
        ("scene.yaml", "camera", "missing"),
        edited(SCENE, "camera:", "# camera:"),
    ),
    Mistake(
        25,
        "surface kind `plain`",
        ("scene.yaml", "surfaces[0].kind", "'plain'", "plane, box"),
        edited(SCENE, "kind: plane", "kind: plain"),
    ),
    Mistake(
        26,
        "`holdd:` in a scenario",
        ("reach.yaml", "holdd", "unknown field", "known: ", "hold"),
        edited(SCENARIO, "hold: 3.0", "holdd: 3.0"),
    ),
    Mistake(
        27,
        "the reference of a task `hnad` in a scenario",
        ("task in a reference", "'hnad'", "known: hand, posture"),
        edited(SCENARIO, "  hand: {position", "  hnad: {position"),
    ),
    Mistake(
        28,
        "two scenario files of one name: both results are kept, and the folder is printed",
        ("results/reach", "and results/reach-"),
        _two_scenarios_of_one_name,
    ),
    Mistake(
        42,
        "`SCENARIO=lemniscat`",
        ("unknown scenario 'lemniscat'", "known: ", "lemniscate"),
        lambda _: refused(lambda: find_scenario("lemniscat")),
    ),
)
