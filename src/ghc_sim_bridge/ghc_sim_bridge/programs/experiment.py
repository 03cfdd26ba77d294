"""`experiment`: run a scenario with each node as a separate process and write its results."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path

from ghc_controller.errors import GhcError
from ghc_sim_bridge.run.folder_lock import folder_lock
from ghc_sim_bridge.run.interrupts import interruptible
from ghc_sim_bridge.scenario.fields import Scenario
from ghc_sim_bridge.scenario.plan import MODES, RECORD_MODES, RunOptions, RunPlan
from ghc_sim_bridge.scenario.planning import make_plan, parse_parameter
from ghc_sim_bridge.scenario.scenario import load_scenario, scenario_names

# Choice -> one run per entry: whether generators smooth; raw bounds first, None = no generators.
_SIDES: Mapping[str | None, tuple[bool | None, ...]] = {
    "on": (True,),
    "off": (False,),
    "both": (False, True),
    None: (None,),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = success, 1 = a run failed, 2 = wrong arguments or files."""
    options = _parser().parse_args(arguments)
    return interruptible("experiment", partial(_run, options))


def _run(options: argparse.Namespace) -> int:
    try:
        parameters = tuple(parse_parameter(text) for text in options.param)
        first = load_scenario(options.scenario, options.variant)
        names = (options.variant,) if options.variant else first.variants or ("",)
        sides = _SIDES[options.generators or ("both" if first.generators else None)]
        run_options = RunOptions(
            formulation=options.formulation,
            transition=options.transition,
            torque_rate=options.torque_rate,
            control_dt=options.dt,
            record=options.record,
            view=options.view,
            mode=options.mode,
            parameters=parameters,
        )
        plans = [
            [
                make_plan(
                    load_scenario(options.scenario, name),
                    replace(run_options, generators=side),
                    options.output,
                )
                for side in _sides_of(load_scenario(options.scenario, name), sides)
            ]
            for name in names
        ]
    except GhcError as error:
        print(f"experiment: {error}", file=sys.stderr)
        return 2
    try:
        with ExitStack() as held:  # until the comparison is written
            for plan in chain.from_iterable(plans):
                held.enter_context(folder_lock(plan.folder))
            return _run_all(first, plans)
    except GhcError as error:
        print(f"experiment: {error}", file=sys.stderr)
        return 1


def _run_all(first: Scenario, plans: Sequence[Sequence[RunPlan]]) -> int:
    """Run all variants, compare them; exit code."""
    done = [_report(sides_of_one) for sides_of_one in plans]
    if len(plans) > 1 and all(done):
        if first.watched_joints and first.generators:
            from ghc_sim_bridge.programs.ways_comparison import compare_ways

            compare_ways([plan for sides_of_one in plans for plan in sides_of_one])
        else:
            from ghc_sim_bridge.programs.report import compare_variants

            compare_variants([sides_of_one[-1] for sides_of_one in plans])
    return int(not all(done))


def _sides_of(scenario: Scenario, sides: tuple[bool | None, ...]) -> tuple[bool | None, ...]:
    """Raw bounds only, for variants with `raw_bounds_only`."""
    return (False,) if scenario.raw_bounds_only else sides


def _report(plans: Sequence[RunPlan]) -> bool:
    """Run one variant with each choice of generators; returns whether all succeeded."""
    # Imported late: checks of names need no ROS.
    from ghc_sim_bridge.programs.generator_comparison import compare_generators
    from ghc_sim_bridge.programs.report import run_and_report, went_well

    try:
        summaries = [run_and_report(plan) for plan in plans]
        if len(plans) > 1:
            compare_generators(plans[0], plans[1], summaries)
        return all(went_well(summary) for summary in summaries)
    except (GhcError, OSError) as error:
        print(f"experiment: {error}", file=sys.stderr)
        return False


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="experiment",
        description="Run a scenario over DDS, every node a process, and write its results.",
        epilog=f"scenarios: {', '.join(scenario_names())}",
    )
    parser.add_argument(
        "--scenario",
        required=True,
        metavar="NAME",
        help="name of a scenario of this package, or a .yaml file",
    )
    parser.add_argument("--variant", default="", help="only this variant of the scenario")
    parser.add_argument("--formulation", help="how tasks and hierarchy become torques")
    parser.add_argument(
        "--transition",
        type=float,
        metavar="SECONDS",
        help="duration of every transition; hqp switches at once by default",
    )
    parser.add_argument(
        "--torque-rate",
        type=float,
        metavar="NM_PER_S",
        help="what every transition may add to the torque rate of any joint; it then takes as "
        "long as this asks, and at least its duration (0 = no such budget)",
    )
    parser.add_argument("--dt", type=float, metavar="SECONDS", help="control period")
    parser.add_argument(
        "--generators",
        choices=("on", "off", "both"),
        help="constraint generators smooth their bounds, pass them through, or one run of each "
        "and a comparison (default: both, where the scenario has generators)",
    )
    parser.add_argument(
        "--record",
        default="decimated",
        choices=RECORD_MODES,
        help="fast topics at 100 Hz, or every message",
    )
    parser.add_argument("--view", action="store_true", help="show the run live in Rerun")
    parser.add_argument("--mode", default=MODES[0], choices=MODES)
    parser.add_argument(
        "--param",
        action="append",
        default=[],
        metavar="NODE:NAME:=VALUE",
        help="a parameter of one node; may be repeated",
    )
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("results"),
        metavar="DIR",
        help="root of all results (default: results)",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
