"""The part of summary.json on balance: base, motors, center of mass, and the load of contacts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from ghc_controller.tasks.center_of_mass import CenterOfMassTask
from ghc_sim_bridge.analysis.analysis import Analysis
from ghc_sim_bridge.analysis.standing import base_motion, torque_use
from ghc_sim_bridge.logs.contact_loads import ContactSurface
from ghc_sim_bridge.logs.controller_trace import ControllerTrace


def balance_summary(analysis: Analysis, trace: ControllerTrace) -> dict[str, Any]:
    """Fields of a robot with a floating base; none for another one."""
    log = analysis.log
    if log.base_pose is None:
        return {}
    motion = base_motion(log.base_pose)
    use, joint = torque_use(log.torque, analysis.limits.torque, log.joint_names)
    return {
        "standing": motion.stands(analysis.plan.scenario.standing_height),
        "base": {
            "height_m": {
                "start": motion.height_start,
                "end": motion.height_end,
                "lowest": motion.height_lowest,
            },
            "tilt_deg": {
                "start": motion.tilt_start,
                "end": motion.tilt_end,
                "largest": motion.tilt_largest,
            },
        },
        "torque_use": {"largest": use, "joint": joint},
        "center_of_mass_largest_distance_m": _center_of_mass_distance(analysis),
        "contact_loads": {
            name: asdict(figures)
            for name, figures in trace.loads.figures(log, _surfaces(analysis)).items()
        },
    }


def balance_lines(summary: Mapping[str, Any]) -> str:
    """The same as text; empty for a robot whose base is fixed."""
    if "base" not in summary:
        return ""
    height, tilt = summary["base"]["height_m"], summary["base"]["tilt_deg"]
    use, distance = summary["torque_use"], summary["center_of_mass_largest_distance_m"]
    lines = [
        f"{'stands' if summary['standing'] else 'DOES NOT STAND'} at the end: base at "
        f"{height['end']:.3f} m ({height['start']:.3f} m at the start), tilted by "
        f"{tilt['end']:.2f} deg ({tilt['start']:.2f}); torque at most "
        f"{100.0 * use['largest']:.0f} % of its limit ({use['joint']})"
    ]
    if distance is not None:
        lines.append(f"center of mass: at most {1e3 * distance:.2f} mm from its target")
    for name, load in summary["contact_loads"].items():
        asked, friction = load["asked_n"], load["friction_use_qp"]
        lines.append(
            f"contact {name}: {asked[0]:.1f} to {asked[1]:.1f} N commanded, simulated differs by "
            f"{load['difference_rms_n']:.2g} N rms, at most {load['difference_largest_n']:.2g} N; "
            f"friction used to {100.0 * friction:.0f} % in the QP, "
            f"{100.0 * load['friction_use_simulated']:.0f} % simulated"
        )
    return "\n".join(lines)


def _center_of_mass_distance(analysis: Analysis) -> float | None:
    """Largest distance [m] over the run, every 10 ms; None without such a task."""
    names = {task.name for task in analysis.robot.tasks if isinstance(task, CenterOfMassTask)}
    errors = [task.error.max() for task in analysis.history.tasks if task.name in names]
    return float(max(errors)) if errors else None


def _surfaces(analysis: Analysis) -> dict[str, ContactSurface]:
    return {
        contact.name: ContactSurface(contact.axes[2], contact.friction)
        for contact in analysis.robot.contacts
    }
