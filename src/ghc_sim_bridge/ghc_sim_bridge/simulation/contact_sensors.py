"""Force and torque at the named contacts of a scene, averaged over a control period."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from ghc_controller.types import Array
from ghc_sim_bridge.scene.values import Contact
from ghc_sim_bridge.simulation.mujoco_model import contact_geom_names


class ContactSensors:
    """Sums MuJoCo's contact forces into one wrench per named contact.

    A wrench is the action of the environment on the robot, reduced to the origin of the
    contact's frame, in world axes: force (3,) [N], then torque (3,) [Nm].
    """

    def __init__(self, model: mujoco.MjModel, contacts: Sequence[Contact]) -> None:
        """Find the spheres and frames of the contacts in the compiled model."""
        self._model = model
        self._wrenches = {contact.name: np.zeros(6) for contact in contacts}
        self._sites = {c.name: model.site(c.frame).id for c in contacts}
        self._contact_of_geom = {
            model.geom(geom).id: contact.name
            for contact in contacts
            for geom in contact_geom_names(contact)
        }
        self._buffer = np.zeros(6)

    def clear(self) -> None:
        """Start a new mean."""
        for wrench in self._wrenches.values():
            wrench[:] = 0.0

    def add(self, data: mujoco.MjData, weight: float) -> None:
        """Add the forces of the physics step just taken, before positions are updated."""
        for k in range(data.ncon):
            contact = data.contact[k]
            # The contact frame's first axis points from geom1 to geom2: the force acts on geom2.
            for geom, sign in ((contact.geom2, weight), (contact.geom1, -weight)):
                name = self._contact_of_geom.get(int(geom))
                if name is None:
                    continue
                mujoco.mj_contactForce(self._model, data, k, self._buffer)
                to_world = contact.frame.reshape(3, 3).T
                force = to_world @ self._buffer[:3] * sign
                torque = to_world @ self._buffer[3:] * sign
                arm = contact.pos - data.site_xpos[self._sites[name]]
                wrench = self._wrenches[name]
                wrench[:3] += force
                wrench[3:] += torque + np.cross(arm, force)

    def jacobian(self, data: mujoco.MjData) -> Array:
        """(m, nv) in MuJoCo's terms: velocity of each touching point along the contact's normal,
        and along both tangents where there is friction."""
        rows = [np.empty((0, self._model.nv))]
        whole = np.empty((3, self._model.nv))
        for contact in data.contact:
            for geom in (contact.geom1, contact.geom2):
                if int(geom) in self._contact_of_geom:
                    body = self._model.geom_bodyid[geom]
                    mujoco.mj_jac(self._model, data, whole, None, contact.pos, body)
                    rows.append(contact.frame.reshape(3, 3)[: contact.dim] @ whole)
        return np.concatenate(rows)

    def wrenches(self) -> Mapping[str, Array]:
        """Name -> (6,) mean wrench since `clear`; copies."""
        return {name: wrench.copy() for name, wrench in self._wrenches.items()}
