"""A robot in MJCF, in a MuJoCo loop of one's own: three joints in a plane and a tip to move.

python examples/robot_in_mjcf.py
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco
import numpy as np

import ghc_controller as ghc

GAINS = {"stiffness": 100.0, "damping": 20.0}  # [1/s^2], [1/s]
LINK = '<body name="link_{k}" pos="0 0 {z}"><joint name="joint_{k}" axis="0 1 0" range="-3 3"/>'
SHAPE = '<geom type="capsule" fromto="0 0 0 0 0 0.3" size="0.03" density="1000"/>'
BODIES = "".join(LINK.format(k=k, z=0.3 * min(k, 1)) + SHAPE for k in range(3))
MOTORS = "".join(f'<motor joint="joint_{k}" ctrlrange="-60 60"/>' for k in range(3))
MJCF = f"""<mujoco model="planar"><option timestep="0.001"/><compiler angle="radian"/>
<worldbody>{BODIES}<site name="tip" pos="0 0 0.3"/></body></body></body></worldbody>
<actuator>{MOTORS}</actuator></mujoco>"""


def main() -> None:
    """Print where the tip is, in MuJoCo, while the controller moves it."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "planar.xml"
        file.write_text(MJCF, encoding="utf-8")
        robot = ghc.Robot.from_urdf(
            file,
            tasks=[
                ghc.frame_position("tip", frame="tip", axes=["x", "z"], **GAINS),
                ghc.posture("posture", **GAINS),
            ],
            hierarchy="tip > posture",
            limits={"velocity": 3.0},  # [rad/s] an MJCF has none
        )
    model = mujoco.MjModel.from_xml_string(MJCF)
    data = mujoco.MjData(model)
    data.qpos[:] = [0.3, 0.6, 0.6]  # [rad]
    mujoco.mj_forward(model, data)
    controller = ghc.Controller(robot)
    controller.start(ghc.RobotState(data.time, data.qpos.copy(), data.qvel.copy()))
    controller.set_reference("tip", [0.55, 0.35])  # [m]
    for tick in range(1, 3001):
        state = ghc.RobotState(1e-3 * (tick - 1), data.qpos.copy(), data.qvel.copy())
        data.ctrl[:] = controller.step(state).torque
        mujoco.mj_step(model, data)
        if tick % 1000 == 0:
            x, _, z = np.round(data.site("tip").xpos, 4) + 0.0
            print(f"t = {1e-3 * tick:.0f} s: tip at x = {x:.3f} m, z = {z:.3f} m")


if __name__ == "__main__":
    main()
