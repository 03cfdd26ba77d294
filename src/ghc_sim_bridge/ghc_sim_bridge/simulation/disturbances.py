"""Disturbances of a simulated robot that the controller does not know, drawn from a seed.

Masses and friction are scaled once, a push comes once, and the velocities that are published are
noisy; the log keeps the truth. The same seed gives the same disturbances.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from ghc_controller.errors import UnknownName
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class Magnitudes:
    """How large disturbances are; all zero = none."""

    mass: float = 0.0  # [-] each link's mass and inertia by a factor in 1 -+ mass
    friction_lower: float = 0.0  # [-] of all contacts, one draw; 0 = the scene's
    friction_upper: float = 0.0  # [-]
    push: float = 0.0  # [N] horizontal, in a direction that is drawn
    push_frame: str = ""  # frame of the URDF that is pushed at its origin
    push_duration: float = 0.1  # [s]
    push_from: float = 0.0  # [s] the push begins between these
    push_until: float = 0.0  # [s]
    velocity_noise: float = 0.0  # [rad/s] standard deviation of the published joint velocities


class Disturbances:
    """The disturbances of one seed."""

    def __init__(self, magnitudes: Magnitudes, seed: int) -> None:
        self._random = np.random.default_rng(seed)
        self._magnitudes = m = magnitudes
        self._seed = seed
        self.friction = float(self._random.uniform(m.friction_lower, m.friction_upper))
        self.push_start = float(self._random.uniform(m.push_from, max(m.push_from, m.push_until)))
        angle = float(self._random.uniform(0.0, 2.0 * np.pi))
        self.push_force: Array = m.push * np.array([np.cos(angle), np.sin(angle), 0.0])

    def change(self, model: mujoco.MjModel) -> None:
        """Scale masses with their inertias, and set the friction of all contacts that have one.

        Raises UnknownName when there is no frame to be pushed.
        """
        m = self._magnitudes
        draw = np.random.default_rng([self._seed, 1])  # its own: as many draws as bodies
        factors = draw.uniform(1.0 - m.mass, 1.0 + m.mass, model.nbody)
        model.body_mass[:] *= factors
        model.body_inertia[:] *= factors[:, None]
        if self.friction > 0.0:
            touching = (model.geom_contype != 0) & (model.geom_condim > 1)
            model.geom_friction[touching, 0] = self.friction
        if m.push > 0.0 and mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, m.push_frame) < 0:
            raise UnknownName(
                "frame to be pushed",
                m.push_frame,
                [model.site(k).name for k in range(model.nsite)],
            )
        mujoco.mj_setConst(model, mujoco.MjData(model))

    def push(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Apply the push at data.time, or none: data.xfrc_applied of the pushed link."""
        m = self._magnitudes
        if m.push <= 0.0:
            return
        site = model.site(m.push_frame).id
        body = int(model.site_bodyid[site])
        data.xfrc_applied[body] = 0.0
        now = data.time
        if self.push_start - 1e-9 <= now < self.push_start + m.push_duration - 1e-9:
            arm = data.site_xpos[site] - data.xipos[body]
            data.xfrc_applied[body, :3] = self.push_force
            data.xfrc_applied[body, 3:] = np.cross(arm, self.push_force)

    def measured(self, velocity: Array) -> Array:
        """Joint velocities (na,) [rad/s] with fresh noise."""
        deviation = self._magnitudes.velocity_noise
        return velocity + deviation * self._random.standard_normal(velocity.shape)
