"""An independent text of task rows and joint limits, in NumPy and Pinocchio.

It never calls the core. Shapes as in TaskRows and Box; derivations: docs/limits.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ghc_controller.types import Array

LWA = pin.LOCAL_WORLD_ALIGNED


class TwinKinematics:
    """Terms of frames and of the center of mass at one state, by Pinocchio."""

    def __init__(self, plain: pin.Model, q: Array, v: Array) -> None:
        self.plain, self.q, self.v, self.data = plain, q, v, plain.createData()
        still = np.zeros(plain.nv)
        pin.forwardKinematics(plain, self.data, q, v, still)
        pin.computeJointJacobians(plain, self.data, q)
        pin.updateFramePlacements(plain, self.data)

    def frame(self, name: str) -> tuple[Array, Array, Array, Array, Array]:
        """Position, rotation, Jacobian (6, n), velocity and drift (6,)."""
        plain, data = self.plain, self.data
        frame = plain.getFrameId(name, pin.BODY)
        place = data.oMf[frame]
        return (
            place.translation.copy(),
            place.rotation.copy(),
            pin.getFrameJacobian(plain, data, frame, LWA),
            pin.getFrameVelocity(plain, data, frame, LWA).vector,
            pin.getFrameClassicalAcceleration(plain, data, frame, LWA).vector,
        )

    def seen(self, name: str, base: str) -> tuple[Array, Array, Array, Array]:
        """Position, rotation, Jacobian and drift of a frame as seen from another one."""
        a, b = self.frame(base), self.frame(name)
        turn, r = a[1].T, b[0] - a[0]
        moved = b[2][:3] - a[2][:3] + pin.skew(r) @ a[2][3:]
        jacobian = np.vstack([turn @ moved, turn @ (b[2][3:] - a[2][3:])])
        w, u = a[3][3:], b[3][:3] - a[3][:3] - np.cross(a[3][3:], r)
        linear = b[4][:3] - a[4][:3] - np.cross(a[4][3:], r) - np.cross(w, np.cross(w, r))
        linear -= 2.0 * np.cross(w, u)
        angular = b[4][3:] - a[4][3:] - np.cross(w, b[3][3:] - w)
        return turn @ r, turn @ b[1], jacobian, np.concatenate([turn @ linear, turn @ angular])

    def center(self) -> tuple[Array, Array, Array]:
        """Position, Jacobian and drift of the center of mass."""
        pin.centerOfMass(self.plain, self.data, self.q, self.v, np.zeros(self.plain.nv))
        position, drift = self.data.com[0].copy(), self.data.acom[0].copy()
        return position, pin.jacobianCenterOfMass(self.plain, self.data, self.q), drift


def pose_error(reference: Array, position: Array, rotation: Array) -> Array:
    """x* - x, then log(R* R^T), (6,); reference x, y, z, qx, qy, qz, qw."""
    wanted = pin.Quaternion(reference[3:]).toRotationMatrix()
    return np.concatenate([reference[:3] - position, pin.log3(wanted @ rotation.T)])


def law(
    error: Array,
    jacobian: Array,
    drift: Array,
    v: Array,
    motion: Array,
    gains: tuple[float, float],
) -> Array:
    """kp e + kd (xi'* - J v) + xi''* - J' v; motion (2, m) of the reference."""
    return np.asarray(motion[1] + gains[0] * error + gains[1] * (motion[0] - jacobian @ v) - drift)


@dataclass(frozen=True)
class TwinJoint:
    """One joint near its limits, all in its own unit."""

    q: float
    v: float
    lower: float
    upper: float
    speed: float
    brake: float
    rate: float
    jerk: float
    dt: float
    horizon: float

    def velocity(self) -> tuple[float, float]:
        """Bounds that keep the speed."""
        least, most = (s * self.speed - self.v for s in (-1.0, 1.0))
        least, most = least / self.horizon, most / self.horizon
        if self.speed > self.v:
            most = min(most, self._fall(self.speed - self.v))
        if self.speed > -self.v:
            least = max(least, -self._fall(self.speed + self.v))
        return least, most

    def position(self) -> tuple[float, float]:
        """Bounds that let the joint stop."""
        most = self._towards(self.upper - self.q, self.v)
        least = -self._towards(self.q - self.lower, -self.v)
        if least > most:
            return (most, most) if self.v > 0.0 else (least, least)
        return least, most

    def _fall(self, margin: float) -> float:
        """a with a (1.5 dt) + a^2 / (2 j) = margin."""
        delay = 1.5 * self.dt
        return self.jerk * (math.sqrt(delay**2 + 2.0 * margin / self.jerk) - delay)

    def _towards(self, room: float, v: float) -> float:
        brake, dt, rate = self.brake, self.dt, self.rate
        approach = rate**2 * room - 2.0 * rate * v
        soft = max(approach, np.clip(-v / dt, -brake, brake))
        return self._planned(min(soft, self._viable(room, v)), room, v)

    def _viable(self, room: float, v: float) -> float:
        """Largest x after which braking with A stops in time."""
        brake, dt, stop, best = self.brake, self.dt, -v / self.dt, -math.inf
        for share in (1.0, 0.5):
            a, b = dt**2 / (2.0 * brake), v * dt / brake + share * dt**2
            inside = b**2 - 4.0 * a * (v**2 / (2.0 * brake) + v * dt - room)
            if inside >= 0.0:
                best = (-b + math.sqrt(inside)) / (2.0 * a)
                if best >= 0.0:
                    break
        if best < stop:
            best = min(stop, 2.0 * (room - v * dt) / dt**2)
        return max(best, stop, -brake)

    def _planned(self, cap: float, room: float, v: float) -> float:
        """Largest a <= cap from which -j and then -A stop in time, by bisection."""
        if room < 0.0 and v < 0.0:
            return min(cap, self._fall(-v))
        late = max(-self.brake, -v / self.dt)
        if room + 1e-5 > 0.0:
            late = max(late, -(v**2) / (2.0 * (room + 1e-5)))
        if room < max(v, 0.0) * self.dt:
            return min(cap, late)
        if self._stops(cap, room, v):
            return cap
        low, high = -self.brake, min(cap, 1e4)
        if not self._stops(low, room, v):
            return min(cap, late if v > 0.0 else -self.brake)
        for _ in range(27):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self._stops(middle, room, v) else (low, middle)
        return low

    def _stops(self, a: float, room: float, v: float) -> bool:
        after = v + a * self.dt
        return after * self.dt + self._travel(after, a) <= room

    def _travel(self, v: float, a: float) -> float:
        jerk, brake = self.jerk, self.brake
        if v <= 0.0 and (a <= 0.0 or a * a + 2.0 * jerk * v <= 0.0):
            return 0.0
        if a <= -brake:
            return v * v / (2.0 * brake)
        time = (a + brake) / jerk
        rest = v + a * time - 0.5 * jerk * time**2
        if rest <= 0.0:
            time, rest = (a + math.sqrt(max(a * a + 2.0 * jerk * v, 0.0))) / jerk, 0.0
        travel = v * time + 0.5 * a * time**2 - jerk * time**3 / 6.0
        return max(travel + rest**2 / (2.0 * brake), 0.0)


def contact_rows(
    terms: tuple[Array, Array, Array, Array, Array],
    points: Array,
    axes: Array,
    rate: float,
) -> tuple[Array, Array]:
    """J_f (p * a, n), and the accelerations that keep the points still along the axes."""
    _, rotation, jacobian, velocity, drift = terms
    w, forces, still = velocity[3:], [], []
    for point in points:
        arm = rotation @ point
        moved = jacobian[:3] - pin.skew(arm) @ jacobian[3:]
        change = drift[:3] + np.cross(drift[3:], arm) + np.cross(w, np.cross(w, arm))
        forces.append(axes @ moved)
        still.append(-axes @ (change + rate * (velocity[:3] + np.cross(w, arm))))
    return np.vstack(forces), np.concatenate(still)
