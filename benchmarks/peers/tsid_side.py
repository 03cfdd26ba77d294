"""tsid (InverseDynamicsFormulationAccForce, eiquadprog): soft weights, limits as constraints."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import tsid

if not hasattr(tsid, "RobotWrapper"):  # the wheel of 1.7.1 is one folder too deep
    from tsid import tsid_pywrap as tsid

from benchmarks.peers.problem import DT, Array, PeerContact, PeerProblem, PeerTask

_FORCE_WEIGHT = 1e-5  # [-] as in tsid's own examples
_MASKS = {"position": (1, 1, 1, 0, 0, 0), "orientation": (0, 0, 0, 1, 1, 1)}


class TsidSide:
    """The control step of tsid."""

    def __init__(self, problem: PeerProblem, urdf: str) -> None:
        """Load the robot and add tasks, contacts and limits."""
        self._problem = problem
        if problem.floating:
            self._robot = tsid.RobotWrapper(urdf, [""], pin.JointModelFreeFlyer(), False)
        else:
            self._robot = tsid.RobotWrapper(urdf, [""], False)
        model = self._robot.model()
        if tuple(model.names)[-len(problem.joints) :] != problem.joints:
            raise ValueError(f"joints {list(model.names)} found, {problem.joints} expected")
        self._law = tsid.InverseDynamicsFormulationAccForce("bench", self._robot, False)
        self._law.computeProblemData(0.0, problem.q[0], problem.v[0])
        self._contacts = [self._contact(contact) for contact in problem.contacts]
        self._tasks: list[tuple[Any, list[Any]]] = []
        for index, task in enumerate(problem.tasks):
            self._add(task, problem.weight(index))
        self._limit()
        self._solver = tsid.SolverHQuadProgFast("bench")
        self._solver.resize(self._law.nVar, self._law.nEq, self._law.nIn)

    def enter(self, row: int) -> None:
        """Take the goals of the segment that begins with a state."""
        for task, samples in self._tasks:
            task.setReference(samples[int(self._problem.segment[row])])

    def step(self, row: int) -> Array | None:
        """Torque (a,) [Nm] at a state; None without an answer."""
        problem = self._problem
        data = self._law.computeProblemData(0.0, problem.q[row], problem.v[row])
        answer = self._solver.solve(data)
        if answer.status != 0:
            return None
        return np.asarray(self._law.getActuatorForces(answer))

    def _add(self, task: PeerTask, weight: float) -> None:
        goals = self._problem.goals[task.name]
        size = {"posture": len(self._problem.joints), "center_of_mass": 3}.get(task.kind, 6)
        made: Any
        if task.kind == "posture":
            made = tsid.TaskJointPosture(task.name, self._robot)
        elif task.kind == "center_of_mass":
            made = tsid.TaskComEquality(task.name, self._robot)
        else:
            made = tsid.TaskSE3Equality(task.name, self._robot, task.frame)
            made.setMask(np.array(_MASKS[task.kind], dtype=float))
            made.useLocalFrame(False)
        made.setKp(task.stiffness * np.ones(size))
        made.setKd(task.damping * np.ones(size))
        if size == 6:
            samples = [
                tsid.TrajectorySE3Constant(task.name, _placement(task, goal)).computeNext()
                for goal in goals
            ]
        else:
            samples = [
                tsid.TrajectoryEuclidianConstant(task.name, goal).computeNext() for goal in goals
            ]
        made.setReference(samples[0])
        self._law.addMotionTask(made, weight, 1, 0.0)
        self._tasks.append((made, samples))

    def _contact(self, contact: PeerContact) -> Any:
        made = tsid.Contact6d(
            contact.name,
            self._robot,
            contact.frame,
            np.array(contact.points).T,
            np.array([0.0, 0.0, 1.0]),
            contact.friction,
            0.0,
            contact.force_upper,
        )
        made.setKp(np.zeros(6))
        made.setKd(20.0 * np.ones(6))
        frame = self._robot.model().getFrameId(contact.frame)
        made.setReference(self._robot.framePosition(self._law.data(), frame))
        self._law.addRigidContact(made, _FORCE_WEIGHT)
        return made

    def _limit(self) -> None:
        problem = self._problem
        torque = tsid.TaskActuationBounds("torque", self._robot)
        torque.setBounds(-problem.torque_limit, problem.torque_limit)
        self._law.addActuationTask(torque, 1.0, 0, 0.0)
        joints = tsid.TaskJointPosVelAccBounds("joints", self._robot, DT, False)
        joints.setPositionBounds(problem.position_lower, problem.position_upper)
        joints.setVelocityBounds(problem.velocity_limit)
        joints.setAccelerationBounds(1e3 * np.ones(len(problem.joints)))
        self._law.addMotionTask(joints, 1.0, 0, 0.0)
        self._limits = (torque, joints)


def _placement(task: PeerTask, goal: Array) -> Any:
    if task.kind == "position":
        return pin.SE3(np.eye(3), goal)
    return pin.SE3(pin.Quaternion(goal).toRotationMatrix(), np.zeros(3))
