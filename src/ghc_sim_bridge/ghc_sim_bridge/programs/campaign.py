"""`campaign`: runs humanoid scenarios under seeded disturbances and counts falls.

Each run is a complete experiment over DDS, with the bridge's parameter `disturbance_seed`. Runs
without and with generators use the same disturbances. campaign.json is rewritten after each run,
so that an interrupted campaign keeps its results.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

from ghc_controller.errors import ConfigurationError, GhcError
from ghc_sim_bridge.analysis.campaign_status import RunStatus, campaign_table, judge, tally
from ghc_sim_bridge.analysis.summary import rounded, write_json
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.run.interrupts import interruptible
from ghc_sim_bridge.scenario.plan import RunOptions, RunPlan
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario

SCENARIOS = ("stand_up", "foot_lift")
RUNS = 20
_SIDES = (False, True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = all runs evaluated, 1 = some failed, 2 = wrong arguments or files."""
    options = _parser().parse_args(arguments)
    return interruptible("campaign", partial(_run, options))


def disturbed_plan(scenario: str, generators: bool, seed: int, output: Path) -> RunPlan:
    """The run of one seed; -1 = undisturbed. Its folder is below `output`."""
    parameters = (("sim_bridge", "disturbance_seed", seed),)
    options = RunOptions(generators=generators, parameters=parameters)
    return make_plan(load_scenario(scenario), options, output)


def _run(options: argparse.Namespace) -> int:
    try:
        # Load every scenario first: errors show before hours of runs.
        for scenario in options.scenarios:
            disturbed_plan(scenario, True, -1, options.output)
    except GhcError as error:
        print(f"campaign: {error}", file=sys.stderr)
        return 2
    found: list[RunStatus] = []
    complete = True
    for scenario in options.scenarios:
        try:
            nominal = _nominal_height(scenario, options.output)
        except GhcError as error:
            print(f"campaign: {scenario} without disturbances: {error}", file=sys.stderr)
            complete = False
            continue
        for seed in range(options.first_seed, options.first_seed + options.runs):
            for generators in _SIDES:
                found.append(_one(scenario, generators, seed, nominal, options.output))
                _write(options.output, found)
                print(f"campaign: {_line(found[-1])}", flush=True)
    print(campaign_table(tally(found)))
    print(f"campaign: {options.output / 'campaign.json'}", flush=True)
    return 0 if complete else 1


def _nominal_height(scenario: str, output: Path) -> float:
    """Height of the base [m] at the end of the undisturbed run with generators."""
    plan = disturbed_plan(scenario, True, -1, output)
    log, _, _ = _log_of(plan)
    if log.base_pose is None:
        raise ConfigurationError(f"robot '{plan.scenario.robot}' has no floating base to fall")
    return float(log.base_pose[-1, 2])


def _one(scenario: str, generators: bool, seed: int, nominal: float, output: Path) -> RunStatus:
    plan = disturbed_plan(scenario, generators, seed, output)
    status = RunStatus(scenario, generators, seed)
    try:
        log, problem, fallback = _log_of(plan)
    except GhcError as error:
        return replace(status, problem=" ".join(str(error).split())[:300])
    status = replace(status, problem=problem, fallback_ticks=fallback)
    status = judge(status, log, nominal)
    if status.stays_up and not problem:  # keep failed runs for inspection
        shutil.rmtree(plan.folder)
    return status


def _log_of(plan: RunPlan) -> tuple[FullRateLog, str, int]:
    """The log of a run, nodes with an abnormal exit (not a failure of the run), fallback ticks."""
    # Imported late: checks of names need no ROS.
    from ghc_sim_bridge.ros.run_experiment import run_experiment

    outcome = run_experiment(plan)
    wrong = [f"{name} ended with {code}" for name, code in outcome.exit_codes.items() if code != 0]
    fallback = int(outcome.trace.counts.get("fallback_ticks") or 0)
    return FullRateLog.load(outcome.log), ", ".join(wrong), fallback


def _line(status: RunStatus) -> str:
    side = "on" if status.generators else "off"
    ending = " ".join(("stays up" if status.stays_up else "falls", status.problem)).rstrip()
    return (
        f"{status.scenario}, generators {side}, seed {status.seed}: {ending} "
        f"(height {status.height:.3f} m, tilt {status.tilt:.3f} rad, "
        f"largest torque rate {status.peak_torque_rate:.0f} Nm/s, "
        f"{status.fallback_ticks} fallback ticks)"
    )


def _write(output: Path, found: Sequence[RunStatus]) -> None:
    output.mkdir(parents=True, exist_ok=True)
    data: dict[str, Any] = {
        "totals": [asdict(total) for total in tally(found)],
        "runs": [asdict(status) for status in found],
    }
    write_json(output / "campaign.json", rounded(data))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="campaign",
        description="Run scenarios under seeded disturbances and count how many stay up.",
    )
    parser.add_argument("--scenarios", nargs="+", default=list(SCENARIOS), metavar="NAME")
    parser.add_argument("--runs", type=int, default=RUNS, help=f"seeds each (default: {RUNS})")
    parser.add_argument("--first-seed", type=int, default=0, metavar="SEED")
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("results/campaign"),
        metavar="DIR",
        help="output folder (default: results/campaign)",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
