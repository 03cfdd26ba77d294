"""Result folders of scenarios: two files with the same name never share a folder."""

from __future__ import annotations

from hashlib import sha1
from pathlib import Path

from ghc_sim_bridge.scenario.fields import Scenario
from ghc_sim_bridge.scenario.scenario import find_scenario, scenario_names

MARK = ".scenario"  # file in a result folder with the path of the scenario's file


def results_home(scenario: Scenario, output: Path) -> Path:
    """Folder of all variants of a scenario under the root `output`.

    Named after the scenario. If this is the name of another scenario, or marked by another file,
    eight digits derived from the path of the file are appended.
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
    """Mark the folder `home` with its scenario's file; creates the folder if needed."""
    home.mkdir(parents=True, exist_ok=True)
    if not _has_its_name(scenario):
        (home / MARK).write_text(str(scenario.file.resolve()), encoding="utf-8")


def _has_its_name(scenario: Scenario) -> bool:
    """Whether the scenario is available by name: of this package, or of a plug-in."""
    if scenario.name not in scenario_names():
        return False
    return find_scenario(scenario.name).resolve() == scenario.file.resolve()
