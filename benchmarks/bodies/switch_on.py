"""A margin between both arms that is raised at once, without and with the generator."""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.bodies.loop import Loop, find_constraint
from ghc_controller.types import Array
from ghc_mpc_constraints import BodyMargins, BodyMarginSettings, MarginSchedule
from ghc_sim_bridge import Simulator

MARGIN = "arms"
RISE = 0.05  # [m] above the distance at that time
_APART = 0.08  # [m] between the targets of both hands
_BEFORE, _AFTER = 3000, 2500  # [ms]
_TICK = 10  # [ms] of the generator
_NO_UPPER = 1e3  # [m]


def switch_on(loop: Loop, formulation: str, seed: int) -> dict[str, Any]:
    """Largest torque rates [Nm/s] around the event, raw and smoothed, and their ratio.

    Both hands hold places beside each other; nobody says in advance that the margin will rise.
    """
    raw, smooth = (_run(loop, formulation, seed, smoothing) for smoothing in (False, True))
    return {
        "raw_nm_per_s": raw["peak"],
        "smoothed_nm_per_s": smooth["peak"],
        "ratio": raw["peak"] / smooth["peak"],
        "distance_m": raw["distance"],
        "left_of_rise_m": max(raw["left"], smooth["left"]),
    }


def _run(loop: Loop, formulation: str, seed: int, smoothing: bool) -> dict[str, float]:
    settings = ghc.Settings(formulation=formulation, torque_rate_limit=0.0)
    controller = ghc.Controller.for_robot(loop.robot, settings)
    constraint, model = find_constraint(controller.robot), controller.model
    simulator = Simulator(loop.scene, joint_names=model.joint_names)
    generator = BodyMargins(BodyMarginSettings(smoothing=smoothing))
    controller.start(simulator.state())
    for task, place in _places(loop, seed).items():
        controller.set_reference(task, place)
    pairs = list(constraint.pairs_of(MARGIN))
    _schedule(generator, float(constraint.pair_margins(0.0)[pairs[0]]), 0.0)
    wanted = at_event = 0.0
    torques = []
    for tick in range(_BEFORE + _AFTER):
        state = simulator.state()
        if tick == _BEFORE:
            at_event = float(constraint.distances()[pairs].min())
            wanted = at_event + RISE
            _schedule(generator, wanted, state.time)
        if tick % _TICK == 0:
            controller.follow(generator.tick(state.time), state.time)
        result = controller.step(state)
        torques.append(result.torque.copy())
        simulator.step(result.torque)
    rates = np.abs(np.diff(np.array(torques), axis=0)).max(axis=1) / 1e-3
    return {
        "peak": float(rates[_BEFORE - 2 :].max()),
        "distance": at_event,
        "left": wanted - float(constraint.distances()[pairs].min()),
    }


def _schedule(generator: BodyMargins, margin: float, time: float) -> None:
    generator.observe(MarginSchedule.checked(MARGIN, [time], [margin], [_NO_UPPER]), time)


def _places(loop: Loop, seed: int) -> dict[str, Array]:
    """Targets (3,) [m] of both hands beside each other, about a random point of their ranges."""
    rng = np.random.default_rng(seed)
    low, high = np.mean([np.array(box).T for box in loop.hands.values()], axis=0)
    middle, side = rng.uniform(0.75 * low + 0.25 * high, 0.25 * low + 0.75 * high), loop.side
    return {
        task: middle + sign * (loop.apart + _APART) / 2.0 * np.array(side)
        for task, sign in zip(loop.hands, (1.0, -1.0), strict=True)
    }
