"""`ros2 run ghc_sim_bridge check_robot robot.yaml`: compares Pinocchio and MuJoCo on a robot."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from ghc_controller.errors import GhcError
from ghc_controller.robot.brakes import deceleration
from ghc_controller.robot.library import load_robot
from ghc_controller.robot.robot import Robot
from ghc_controller.robot.urdf_text import parse_urdf, resource_path
from ghc_sim_bridge.programs.markdown import number, table
from ghc_sim_bridge.scene.description import SceneDescription, load_scene
from ghc_sim_bridge.simulation.simulator import Simulator

_SEED = 0
_STATES = 5  # number of compared states
_SPREAD = 0.5  # [rad] or [m], [rad/s] or [m/s] of the states about the start
_AGREE = 1e-6  # [-] of the largest entry: tolerance between the engines


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = usable, 1 = problems found, one line each."""
    parser = argparse.ArgumentParser(prog="check_robot", description=__doc__.splitlines()[0])
    parser.add_argument("robot", help="name of a robot, or the path of a robot.yaml")
    parser.add_argument("--scene", help="name or path; left out = scene.yaml beside robot.yaml")
    options = parser.parse_args(arguments)
    try:
        robot = load_robot(options.robot)
        print("\n\n".join(describe(robot)))
        scene = _scene(robot, options.scene)
        if scene is None:
            print("\nno scene: the simulator's side was not checked; give one with --scene")
        faults = list(find_faults(robot, scene))
    except GhcError as error:
        print(f"check_robot: {error}", file=sys.stderr)
        return 1
    for fault in faults:
        print(f"check_robot: {fault}", file=sys.stderr)
    if not faults:
        print("\nnothing wrong was found")
    return 1 if faults else 0


def describe(robot: Robot) -> Iterator[str]:
    """Markdown: joints with limits, frames, tasks, contacts."""
    model = robot.model
    base = "floating" if robot.floating_base else "fixed"
    yield f"{robot.name}: {robot.urdf}\n{model.na} joints, {base} base, {model.mass:.4g} kg"
    rows = zip(
        model.joint_names,
        model.position_lower,
        model.position_upper,
        model.velocity_limit,
        model.torque_limit,
        strict=True,
    )
    yield table(
        ["joint", "lower [rad, m]", "upper", "velocity [1/s]", "torque [Nm, N]"],
        [[name, *(number(float(value), 3) for value in limits)] for name, *limits in rows],
    )
    least = deceleration(model).least_held
    weakest = int(np.argmin(least))
    yield (
        f"brake_acceleration {robot.brake_acceleration:g} rad/s^2; torque limits and gravity "
        f"leave {least[weakest]:.3g} at least, to joint '{model.joint_names[weakest]}' while the "
        "others keep their motion"
    )
    yield "frames: " + ", ".join(model.frame_names)
    tasks = "\n".join(f"- {task.name}: {len(task.labels)} rows" for task in robot.tasks)
    yield f"hierarchy: {robot.hierarchy}\n{tasks}"
    if robot.contacts:
        yield "contacts: " + ", ".join(contact.name for contact in robot.contacts)


def find_faults(robot: Robot, scene: SceneDescription | None) -> Iterator[str]:
    """Problems, one line each: missing meshes, differences between the engines."""
    yield from _missing_meshes(robot.urdf)
    if scene is None:
        return
    model = robot.model
    simulator = Simulator(scene, joint_names=model.joint_names)
    if simulator.floating_base != robot.floating_base:
        yield f"{scene.file}: base: only one of scene and robot has a floating base"
        return
    rng = np.random.default_rng(_SEED)
    worst = {"mass matrix": 0.0, "bias torque": 0.0}
    for _ in range(_STATES):
        q = model.integrate(simulator.start, rng.uniform(-_SPREAD, _SPREAD, model.nv))
        v = rng.uniform(-_SPREAD, _SPREAD, model.nv)
        simulator.reset(q, v)
        state = simulator.state()
        dynamics = model.update(state.q, state.v)
        pairs = {
            "mass matrix": (simulator.mass_matrix(), dynamics.mass_matrix),
            "bias torque": (simulator.bias(), dynamics.bias),
        }
        for what, (theirs, ours) in pairs.items():
            size = max(float(np.abs(ours).max()), 1e-9)
            worst[what] = max(worst[what], float(np.abs(theirs - ours).max()) / size)
    for what, difference in worst.items():
        if difference > _AGREE:
            yield (
                f"{robot.urdf}: {what} of MuJoCo and Pinocchio differ by {difference:.1e} of the "
                "largest entry; links without a valid inertia are changed by MuJoCo"
            )


def _missing_meshes(urdf: Path) -> Iterator[str]:
    for mesh in parse_urdf(urdf).iter("mesh"):
        name = mesh.get("filename", "")
        if not resource_path(name, urdf).is_file():
            yield f"{urdf}: mesh '{name}' does not exist; pictures leave that shape out"


def _scene(robot: Robot, given: str | None) -> SceneDescription | None:
    if given is not None:
        return load_scene(given)
    beside = robot.path.parent / "scene.yaml"
    return load_scene(beside) if beside.is_file() else None
