"""Robot models that come as Python packages, installed from their lock when they are asked for.

`python -m tools.model_packages SCENARIO` sees to the robot of a scenario, `--all` to those of
all robots. Run by the Python of .venv in the workspace's environment.
"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from tools.workspace.environment import step_environment, uv_settings
from tools.workspace.errors import SetupError
from tools.workspace.layout import Layout, Way
from tools.workspace.run import Runner


def install_missing(
    package: str, layout: Layout, lock: Path | None = None, purpose: str = "the model of a robot"
) -> None:
    """Install a lock unless `package` is there; SetupError when that fails.

    Args:
        lock: that of the robot models when not given.
        purpose: what it is for, in messages.
    """
    try:
        distribution(package)
        return
    except PackageNotFoundError:
        pass
    lock = lock or layout.models_lock(sys.version_info[:2])
    print(
        f"set-up: installing {lock.relative_to(layout.root)} (for {purpose})",
        file=sys.stderr,
        flush=True,
    )
    run = Runner(layout.root)
    environment = step_environment(layout, Way.WHEELS, os.environ)
    pip_config = run.output([sys.executable, "-m", "pip", "config", "list"], environment)
    run(
        [str(layout.venv / "bin" / "uv"), "pip", "install", "--require-hashes", "-r", str(lock)],
        {**environment, **uv_settings(pip_config, environment)},
        f"the package '{package}' (for {purpose}) could not be installed",
    )
    importlib.invalidate_caches()


def packages_of(robots: list[str]) -> list[str]:
    """Names of the packages that the URDFs of some robots come with."""
    from ghc_controller.robot.library import find_robot
    from ghc_controller.robot.urdf import package_of
    from ghc_controller.schema.reader import read_yaml

    files = [find_robot(robot) for robot in robots]
    names = [package_of(read_yaml(file).value("urdf"), file) for file in files]
    return sorted({name for name in names if name})


def main(arguments: list[str] | None = None) -> int:
    """Install what is missing; 0 when it is there, 1 when it could not be installed."""
    from ghc_controller.errors import GhcError
    from ghc_controller.robot.library import list_robots
    from ghc_sim_bridge.scenario.scenario import load_scenario

    parser = argparse.ArgumentParser(prog="python -m tools.model_packages", description=__doc__)
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("scenario", nargs="?", help="name or path of a scenario")
    which.add_argument("--all", action="store_true", help="the models of all robots")
    options = parser.parse_args(arguments)
    layout = Layout(Path(__file__).resolve().parents[1])
    try:
        robots = list_robots() if options.all else [load_scenario(options.scenario).robot]
        packages = packages_of(list(robots))
    except GhcError:
        return 0  # the experiment that follows says what is wrong with its scenario
    try:
        for package in packages:
            install_missing(package, layout)
    except SetupError as error:
        print(f"set-up: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
