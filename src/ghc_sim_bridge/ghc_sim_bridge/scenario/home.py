"""Where the results of a scenario go: two files of one name never share a folder."""

from __future__ import annotations

from hashlib import sha1
from pathlib import Path

from ghc_sim_bridge.scenario.fields import Scenario
from ghc_sim_bridge.scenario.scenario import find_scenario, scenario_names

MARK = ".scenario"  # file that says whose folder it is: the path of the scenario's file


def results_home(scenario: Scenario, output: Path) -> Path:
    """Folder of all variants of a scenario under the root `output`.

    It has the scenario's name. Where that is the name of another scenario, or is marked by another
    file, the name is followed by eight digits made from the path of the file.
    """
    home = output / scenario.name
    if _has_its_name(scenario):
        return home
    path = str(scenario.file.resolve())
    mark = home / MARK
    marked = mark.is_file() and mark.read_text(encoding="utf-8") != path
    if marked or scenario.name in scenario_names():
        return output / f"{scenario.name}-{sha1(path.encode()).hexdigest()[:8]}"
    return home


def mark_home(scenario: Scenario, home: Path) -> None:
    """Say in the folder `home`, which is made if need be, whose it is."""
    home.mkdir(parents=True, exist_ok=True)
    if not _has_its_name(scenario):
        (home / MARK).write_text(str(scenario.file.resolve()), encoding="utf-8")


def _has_its_name(scenario: Scenario) -> bool:
    """Whether the scenario is found by its name: of this package, or of a plug-in."""
    if scenario.name not in scenario_names():
        return False
    return find_scenario(scenario.name).resolve() == scenario.file.resolve()
