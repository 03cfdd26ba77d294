"""Where the results of a scenario go: two files of one name never share a folder."""

from __future__ import annotations

from hashlib import sha1
from importlib import resources
from pathlib import Path

from ghc_sim_bridge.scenario.scenario import Scenario, scenario_names

MARK = ".scenario"  # file that says whose folder it is: the path of the scenario's file


def results_home(scenario: Scenario, output: Path) -> Path:
    """Folder of all variants of a scenario under the root `output`.

    It has the scenario's name. Where that belongs to a scenario of this package, or is marked by
    another file, the name is followed by eight digits made from the path of the file.
    """
    home = output / scenario.name
    if _is_of_the_package(scenario.file):
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
    if not _is_of_the_package(scenario.file):
        (home / MARK).write_text(str(scenario.file.resolve()), encoding="utf-8")


def _is_of_the_package(file: Path) -> bool:
    folder = Path(str(resources.files("ghc_sim_bridge") / "scenario" / "data"))
    return file.resolve().parent == folder.resolve()
