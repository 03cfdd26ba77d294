"""placo (DynamicsSolver, eiquadprog): soft weights, symmetric limits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import placo

from benchmarks.peers.problem import DT, Array, PeerContact, PeerProblem, PeerTask


class PlacoSide:
    """The control step of placo."""

    def __init__(self, problem: PeerProblem, urdf: str) -> None:
        """Load the robot and add tasks, contacts and limits."""
        self._problem = problem
        self._robot = placo.RobotWrapper(urdf, placo.Flags.ignore_collisions)
        if tuple(self._robot.joint_names()) != problem.joints:
            found = list(self._robot.joint_names())
            raise ValueError(f"joints {found} found, {problem.joints} expected")
        self._solver = placo.DynamicsSolver(self._robot)
        self._solver.dt = DT
        if not problem.floating:
            self._solver.mask_fbase(True)
        self._show(0)
        for joint, torque, speed in zip(
            problem.joints, problem.torque_limit, problem.velocity_limit, strict=True
        ):
            self._robot.set_torque_limit(joint, torque)
            self._robot.set_velocity_limit(joint, speed)
        self._solver.enable_torque_limits(True)
        self._solver.enable_velocity_limits(True)
        self._solver.enable_joint_limits(True)
        self._contacts = [self._contact(contact) for contact in problem.contacts]
        self._tasks = [
            (task, self._add(task, problem.weight(index)))
            for index, task in enumerate(problem.tasks)
        ]

    def enter(self, row: int) -> None:
        """Take the goals of the segment that begins with a state."""
        for task, made in self._tasks:
            self._refer(task, made, int(self._problem.segment[row]))

    def step(self, row: int) -> Array | None:
        """Torque (a,) [Nm] at a state; None without an answer."""
        self._show(row)
        try:
            answer = self._solver.solve()
        except RuntimeError:  # what it raises without an answer
            return None
        return np.asarray(answer.tau)[6:] if answer.success else None

    def _show(self, row: int) -> None:
        state, problem = self._robot.state, self._problem
        if problem.floating:
            state.q, state.qd = problem.q[row], problem.v[row]
        else:
            state.q = np.concatenate([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], problem.q[row]])
            state.qd = np.concatenate([np.zeros(6), problem.v[row]])
        self._robot.update_kinematics()

    def _add(self, task: PeerTask, weight: float) -> Any:
        goal = self._problem.goals[task.name][0]
        made: Any
        if task.kind == "position":
            made = self._solver.add_position_task(task.frame, goal)
        elif task.kind == "orientation":
            made = self._solver.add_orientation_task(task.frame, _rotation(goal))
        elif task.kind == "center_of_mass":
            made = self._solver.add_com_task(goal)
        else:
            made = self._solver.add_joints_task()
            made.set_joints(dict(zip(self._problem.joints, goal, strict=True)))
        made.configure(task.name, "soft", weight)
        made.kp, made.kd = task.stiffness, task.damping
        return made

    def _refer(self, task: PeerTask, made: Any, segment: int) -> None:
        goal = self._problem.goals[task.name][segment]
        if task.kind == "orientation":
            made.R_world_frame = _rotation(goal)
        elif task.kind == "posture":
            made.set_joints(dict(zip(self._problem.joints, goal, strict=True)))
        else:
            made.target_world = goal

    def _contact(self, contact: PeerContact) -> Any:
        """A plane of the size of the sole; its center is that of the frame."""
        frame = self._solver.add_frame_task(
            contact.frame, self._robot.get_T_world_frame(contact.frame)
        )
        frame.configure(contact.name, "hard", 1.0)
        for part in (frame.position(), frame.orientation()):
            part.kp, part.kd = 0.0, 20.0
        made = self._solver.add_planar_contact(frame)
        size = 2.0 * np.abs(np.array(contact.points)).min(axis=0)
        made.length, made.width = float(size[0]), float(size[1])
        made.mu, made.unilateral = contact.friction, True
        return made


def _rotation(goal: Array) -> Array:
    return np.asarray(pin.Quaternion(goal).toRotationMatrix())
