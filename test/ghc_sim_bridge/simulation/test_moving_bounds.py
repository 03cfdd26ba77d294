"""Controller, generators and simulator in one process: bounds that move make torques that do."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ghc_controller.contacts.registry import make_contact
from ghc_controller.controller import Controller
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.schema.reader import Fields
from ghc_controller.settings import Settings
from ghc_controller.types import Array, RobotState
from ghc_mpc_constraints.generators.contact_forces import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_mpc_constraints.generators.obstacle_motion import ObstacleBounds, ObstacleSettings
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_sim_bridge.simulation.simulator import Simulator

DT, TICK, SENSOR = 1e-3, 10, 100  # [s], then periods of the generators and of the sensor
SETTINGS = Settings(torque_rate_limit=0.0, velocity_limit=1.2, control_dt=DT)


@dataclass(frozen=True)
class Run:
    """One row a control period."""

    torque: Array  # (T, 7) [Nm]
    wanted: Array  # (T,) what the controller asks for: normal force [N], or distance [m]
    bound: Array  # (T,) its bound
    measured: Array  # (T,) the same in the simulation

    def peak_rate(self, start: float, end: float) -> float:
        """Largest torque change between two times [s], over the period [Nm/s]."""
        part = self.torque[round(start / DT) : round(end / DT)]
        return float(np.abs(np.diff(part, axis=0)).max() / DT)


def _pushing(smoothing: bool) -> Run:
    """The arm pushes on a table with 20 N; from 2 s on 12 N are allowed, from 3 s on nothing."""
    simulator = Simulator("kuka_lwr_plane", control_dt=DT, physics_dt=DT)
    q = np.array([-0.683, -0.967, 0.937, 1.640, -0.413, 0.134, 0.0])
    robot = load_robot_config(find_robot("kuka_lwr"))
    entry: dict[str, object] = {
        "name": "tool",
        "frame": "tool",
        "points": [[0, 0, 0]],
        "normal": [0, 0, 1],
    }
    entry |= {"friction": 0.0, "force_task": {"weight": 1.0}}
    contact = make_contact(Fields(entry, "test"), robot.model)
    controller = Controller(replace(robot, contacts=(contact,)), SETTINGS)
    simulator.reset(_above_the_table(controller, q))
    generator = ContactForceBounds(ForceBoundSettings(smoothing=smoothing))
    schedule = ContactSchedule.checked(
        "tool", [0.0, 1.0, 2.0, 3.0], [0.0] * 4, [0.0, 40.0, 12.0, 0.0], []
    )
    generator.observe(schedule, 0.0)
    controller.observe(_state(simulator, None))
    task = controller.schedule_of("tool").task("tool")
    push = ReferenceTrajectory.for_task(task, np.zeros(1), np.ones((1, 1)), wrench=[[20.0]])
    controller.add_reference(push)
    hand = controller.references.task("end_effector")
    elbow = controller.references.task("elbow")
    still = elbow.current(controller.model)[None]
    controller.add_reference(ReferenceTrajectory.for_task(elbow, np.zeros(1), still))
    down = np.array([[0.6, 0.0, 0.3002], [0.6, 0.0, 0.2998]])
    controller.add_reference(ReferenceTrajectory.for_task(hand, np.array([0.0, 0.5]), down))
    torque: Array | None = None
    rows = []
    for tick in range(4000):
        if tick % TICK == 0:
            controller.force_bounds.follow(generator.tick(tick * DT))
        result = controller.step(_state(simulator, torque))
        torque = result.torque
        bounds = controller.force_bounds.at(tick * DT)
        force = controller.contacts.normal_forces(bounds.active, result.solution.force)
        simulator.step(torque)
        rows.append((force[0], bounds.upper[0], simulator.contact_wrenches()["tool"][2], *torque))
    table = np.array(rows)
    return Run(table[:, 3:], table[:, 0], table[:, 1], table[:, 2])


def _above_the_table(controller: Controller, q: Array) -> Array:
    """Posture with the tool's ball 0.2 mm above the table, by Newton steps on its position."""
    model = controller.model
    frame = model.frame_id("tool")
    for _ in range(50):
        model.update(q, np.zeros(7))
        error = np.array([0.6, 0.0, 0.3002]) - model.frame_position(frame)
        q = q + np.linalg.pinv(model.frame_jacobian(frame)[:3]) @ error
    return q


def _avoiding(smoothing: bool) -> Run:
    """The arm stands still; an obstacle jumps 50 mm into its safe distance at 1 s, out at 3 s."""
    simulator = Simulator("kuka_lwr", control_dt=DT, physics_dt=DT)
    controller = Controller.for_robot("kuka_lwr", SETTINGS)
    generator = ObstacleBounds(ObstacleSettings(smoothing=smoothing))
    controller.observe(_state(simulator, None))
    start = controller.references.task("end_effector").current(controller.model)
    frame = controller.model.frame_id("tool")
    torque: Array | None = None
    rows = []
    for tick in range(5000):
        time = tick * DT
        if tick % SENSOR == 0:
            position = simulator.frame_position("tool")
            gap = 0.01 if 1.0 <= time < 3.0 else 0.3
            obstacle = np.array([position[0], start[1] + gap, position[2]])
            distance = float(obstacle[1] - position[1])
            measured = Measurement.checked(
                "box", "tool", obstacle.tolist(), [0.0, -1.0, 0.0], distance, 0.06
            )
            generator.observe([measured], time)
        if tick % TICK == 0:
            controller.obstacles.follow(generator.tick(time))
        result = controller.step(_state(simulator, torque))
        torque = result.torque
        ((_, state),) = controller.obstacles.states(time)
        virtual = state[0][1] - controller.model.frame_position(frame)[1]
        real = obstacle[1] - controller.model.frame_position(frame)[1]
        simulator.step(torque)
        rows.append((virtual, 0.06, real, *torque))
    table = np.array(rows)
    return Run(table[:, 3:], table[:, 0], table[:, 1], table[:, 2])


def _state(simulator: Simulator, torque: Array | None) -> RobotState:
    state = simulator.state()
    return RobotState(simulator.time, state.q, state.v, torque)


def test_a_force_follows_its_moving_bound() -> None:
    """Ten times lower torque rates at every jump of the schedule; QP and contact keep to them."""
    raw, smooth = _pushing(False), _pushing(True)
    for jump in (1.0, 2.0, 3.0):
        window = (jump - 0.5, jump + 0.5)
        assert smooth.peak_rate(*window) < 0.1 * raw.peak_rate(*window)
    for run in (raw, smooth):
        assert (run.wanted <= run.bound + 1e-3).all()
    assert np.abs(smooth.measured - smooth.wanted)[200:].max() < 0.5
    assert abs(smooth.wanted[1400] - 20.0) < 0.01


def test_an_obstacle_that_jumps_pushes_the_arm_gently() -> None:
    """Ten times lower torque rates; the virtual distance is kept, the real one soon after."""
    raw, smooth = _avoiding(False), _avoiding(True)
    for start, end in ((0.9, 2.5), (2.9, 4.5)):
        assert smooth.peak_rate(start, end) < 0.1 * raw.peak_rate(start, end)
    assert (smooth.wanted > smooth.bound - 1e-3).all()
    assert smooth.measured[2500] > 0.06 - 1e-3
