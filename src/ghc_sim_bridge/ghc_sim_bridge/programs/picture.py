"""`picture`: animation (GIF) or filmstrip (PNG) of a run recorded by `experiment`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ghc_controller.errors import GhcError
from ghc_controller.robot.library import find_robot
from ghc_sim_bridge.analysis.analysis import analyse
from ghc_sim_bridge.figures.animation import frames, save_gif
from ghc_sim_bridge.figures.filmstrip import FRAMES, write_filmstrip
from ghc_sim_bridge.scenario.plan import RunOptions
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario
from ghc_sim_bridge.scene.description import load_scene

_SIDES = {None: None, "on": True, "off": False}


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = written, 2 = wrong arguments or files, or no off-screen OpenGL."""
    options = _parser().parse_args(arguments)
    try:
        scenario = load_scenario(options.scenario, options.variant)
        run = RunOptions(
            formulation=options.formulation,
            transition=options.transition,
            generators=_SIDES[options.generators],
        )
        plan = make_plan(scenario, run, options.results)
        changed = plan.folder / "robot.yaml"
        robot = changed if changed.is_file() else find_robot(scenario.robot)
        analysis = analyse(plan, plan.folder / "log.npz", robot)
        scene = load_scene(scenario.scene)
        if options.to.suffix == ".png":
            count = options.frames
            times = np.linspace(0.0, plan.duration, count).tolist()
            write_filmstrip(options.to, analysis.log, scene, times)
        else:
            step = options.speed * options.period
            pictures = list(frames(analysis, scene, step, plots=not options.robot_only))
            save_gif(pictures, options.to, options.period)
            count = len(pictures)
    except (GhcError, OSError) as error:
        print(f"picture: {error}", file=sys.stderr)
        return 2
    size = options.to.stat().st_size / 1e6
    print(f"{options.to}: {count} pictures, {size:.2f} MB")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="picture", description="Animate a finished run: the robot, its targets, the plots."
    )
    parser.add_argument("--scenario", required=True, metavar="NAME")
    parser.add_argument("--variant", default="", metavar="NAME")
    parser.add_argument("--formulation", metavar="NAME")
    parser.add_argument("--transition", type=float, metavar="SECONDS")
    parser.add_argument(
        "--results", type=Path, default=Path("results"), metavar="DIR", help="root of all results"
    )
    parser.add_argument(
        "--to",
        type=Path,
        required=True,
        metavar="FILE",
        help=".gif to write (an animation), or .png (a strip of frames)",
    )
    parser.add_argument(
        "--frames", type=int, default=FRAMES, metavar="N", help=f"of a strip (default: {FRAMES})"
    )
    parser.add_argument(
        "--speed", type=_positive, default=4.0, help="simulated seconds a second (default: 4)"
    )
    parser.add_argument(
        "--period",
        type=_positive,
        default=0.1,
        metavar="SECONDS",
        help="between two pictures (default: 0.1)",
    )
    parser.add_argument(
        "--generators", choices=("on", "off"), help="which side of a scenario that has generators"
    )
    parser.add_argument(
        "--robot-only", action="store_true", help="an animation without caption and plots"
    )
    return parser


def _positive(text: str) -> float:
    value = float(text)
    if not value > 0.0:
        raise argparse.ArgumentTypeError(f"{text} given, more than 0 expected")
    return value


if __name__ == "__main__":
    sys.exit(main())
