"""Parameters of the controller node."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.constraints import TorqueCenter
from ghc_controller.formulations import (
    DEFAULT_FORMULATION,
    FORMULATIONS,
    DampedLevels,
    FormulationSettings,
    Metric,
    TorqueRegularization,
)
from ghc_controller.hierarchy import ProjectorSettings
from ghc_controller.ros.node_parameters import (
    EXECUTOR,
    given,
    not_negative,
    one_of,
    parameter,
    positive,
    several_of,
)
from ghc_controller.safety.modes import Arming
from ghc_controller.settings import Settings


@dataclass(frozen=True, slots=True)
class ControllerParameters:
    """Parameters of controller."""

    robot: str = parameter("", "name of a robot, or path of its robot.yaml", given)
    formulation: str = parameter(DEFAULT_FORMULATION, ", ".join(FORMULATIONS))
    qp_solver: str = parameter("daqp", "daqp or proxqp")
    control_dt: float = parameter(0.001, "[s] control period", positive)
    hierarchy: str = parameter("", "hierarchy at the start; empty = of the robot's file")
    regularization: float = parameter(1e-2, "[-] weight on nu'_i, or damping per level", positive)
    velocity_damping: float = parameter(
        20.0,
        "[1/s] kd: damping pulls to -kd v; 0 = to zero, as in the papers",
        not_negative,
    )
    null_damping: float = parameter(
        3e-5, "[-] e: null spaces of cascade open over singular values of this size", positive
    )
    torque_regularization: str = parameter(
        "none",
        "what a weight on torque pulls to (ghc, ghc_full): none, bias or zero",
        one_of("none", "bias", "zero"),
    )
    hqp_damps_velocity: bool = parameter(
        False, "hqp uses velocity_damping as well; false = damping of the literature"
    )
    damped_levels: str = parameter(
        "all",
        "levels that w damps in task_priority and its baselines: all, lower (all but the first) "
        "or none",
        one_of(*(kind.value for kind in DampedLevels)),
    )
    metric: str = parameter(
        "acceleration",
        "what task_priority and ghc make least beside the tasks: acceleration, inertia "
        "(operational space, dynamically consistent projectors) or torque",
        one_of(*(kind.value for kind in Metric)),
    )
    rhp_constant_weights: bool = parameter(
        False, "rhp_hqp weighs rows alike at any phi, as its authors' library; jumps in a swap"
    )
    second_order: bool = parameter(
        False, "add the curvature of the tasks to every level; ghc and ghc_full reject it"
    )
    layer_damping: float = parameter(
        -1.0,
        "[-] damped projector layers: continuous at rank changes; 0 = exact, "
        "negative = of the formulation: balanced 2.5e-6, the others 0",
    )
    velocity_limit: float = parameter(
        0.0, "[rad/s] of every joint; 0 = of the robot", not_negative
    )
    velocity_horizon: float = parameter(
        0.05, "[s] over which velocity limits act; 0.01 to 0.05", positive
    )
    torque_bound: float = parameter(0.0, "[Nm] of every joint; 0 = of the robot", not_negative)
    torque_bound_around: str = parameter(
        "zero", "centre of torque_bound: zero or gravity", one_of("zero", "gravity")
    )
    torque_rate_limit: float = parameter(
        -1.0, "[Nm/s] rows and gate; 0 = off, negative = of the robot"
    )
    position_limits: bool = parameter(True, "keep joint positions in their range")
    velocity_limits: bool = parameter(True, "keep joint velocities below their limit")
    lockstep: bool = parameter(
        False, "refuse references and transitions whose start has passed, for repeatable runs"
    )
    arming: str = parameter(
        "",
        "what makes the controller move the robot: request (the first one accepted), explicit "
        "(the service controller/arm alone) or automatic (the first state; faults are not "
        "latched); empty = automatic in lockstep, else request",
        one_of("", *(kind.value for kind in Arming)),
    )
    state_rate: float = parameter(
        100.0,
        "[Hz] of the robot's time: controller_state; priority_matrix while it changes",
        positive,
    )
    wait_for_contacts: tuple[str, ...] = parameter(
        (), "contacts whose wrench of the same stamp a step waits for"
    )
    wait_for_bounds: tuple[str, ...] = parameter(
        (),
        "plans that a step waits for: contact_force_bounds, obstacle_motion",
        several_of("contact_force_bounds", "obstacle_motion"),
    )
    bounds_step: float = parameter(0.01, "[s] between two plans of a generator", positive)
    obstacle_horizon: float = parameter(
        0.1, "[s] over which an obstacle's distance is kept (delta t of eq. 4.2)", positive
    )
    mirror_commands: bool = parameter(
        False, "publish /effort_controller/commands as well, order of the robot model"
    )
    executor: str = EXECUTOR

    @property
    def armed_by(self) -> Arming:
        """What makes the controller active."""
        default = Arming.AUTOMATIC if self.lockstep else Arming.REQUEST
        return Arming(self.arming) if self.arming else default

    def settings(self) -> Settings:
        """Settings of the controller; GhcError for a value out of range."""
        return Settings(
            formulation=self.formulation,
            solver=self.qp_solver,
            control_dt=self.control_dt,
            hierarchy=self.hierarchy,
            velocity_limit=self.velocity_limit,
            velocity_horizon=self.velocity_horizon,
            obstacle_horizon=self.obstacle_horizon,
            torque_bound=self.torque_bound,
            torque_bound_around=TorqueCenter(self.torque_bound_around),
            torque_rate_limit=self.torque_rate_limit,
            position_limits=self.position_limits,
            velocity_limits=self.velocity_limits,
            optimization=FormulationSettings(
                regularization=self.regularization,
                velocity_damping=self.velocity_damping,
                null_damping=self.null_damping,
                torque_regularization=TorqueRegularization(self.torque_regularization),
                hqp_damps_velocity=self.hqp_damps_velocity,
                damped_levels=DampedLevels(self.damped_levels),
                metric=Metric(self.metric),
                rhp_constant_weights=self.rhp_constant_weights,
                second_order=self.second_order,
                projector=ProjectorSettings(
                    layer_damping=None if self.layer_damping < 0.0 else self.layer_damping
                ),
            ),
        )
