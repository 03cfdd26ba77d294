"""Every name of earlier versions gives an error that says the new one, row by row."""

from __future__ import annotations

import importlib
from importlib.util import find_spec
from typing import Any

import pytest
import yaml
from doc_text import ROOT

import ghc_controller as ghc
from docs.migration_tables import DOCUMENT, rendered
from ghc_controller.errors import ConfigurationError, GhcError
from ghc_controller.migration.modules import FOLDERS, MODULES
from ghc_controller.migration.names import RENAMED, Kind, Renamed
from ghc_controller.ros.parameters import ControllerParameters
from ghc_controller.schema.declared import flat
from ghc_sim_bridge.run.executables import find_executable
from ghc_sim_bridge.scenario.scenario import find_scenario, load_scenario


def rows(kind: Kind) -> list[Renamed]:
    found = [row for row in RENAMED if row.kind is kind]
    assert found
    return found


def new_home(old: str) -> str:
    """Where the first of a module and the folders around it that has moved is now."""
    parts = old.split(".")
    around = [".".join(parts[:k]) for k in range(2, len(parts) + 1)]
    return next(MODULES[name] for name in around if name in MODULES)


@pytest.mark.parametrize("old", MODULES)
def test_an_old_module_says_where_it_is(old: str) -> None:
    with pytest.raises(ModuleNotFoundError) as error:
        importlib.import_module(old)
    assert f"is in {new_home(old)} now" in str(error.value)
    assert find_spec(MODULES[old]) is not None


@pytest.mark.parametrize("folder", FOLDERS)
def test_what_was_in_a_module_that_is_a_folder_now_is_found(folder: str) -> None:
    with pytest.raises(
        ModuleNotFoundError, match=rf"'thing' from '{folder}': see {FOLDERS[folder]}"
    ):
        exec(f"from {folder} import thing")
    assert find_spec(FOLDERS[folder]) is not None


@pytest.mark.parametrize("row", rows(Kind.NAME), ids=lambda row: row.old)
def test_an_old_public_name(row: Renamed) -> None:
    """As an attribute and in an import; `hasattr` stays a question."""
    assert not hasattr(ghc, row.old)
    assert getattr(ghc, row.new) is not None
    with pytest.raises(AttributeError, match=f"it is '{row.new}' now"):
        getattr(ghc, row.old)
    with pytest.raises(ImportError, match=f"it is '{row.new}' now"):
        exec(f"from ghc_controller import {row.old}")


def test_an_old_method_of_the_controller() -> None:
    controller = ghc.Controller.for_robot("kuka_lwr")
    old = [row for row in rows(Kind.METHOD) if row.old.startswith("Controller.")]
    assert old
    for row in old:
        name, new = row.old.split(".")[1], row.new.split(".")[1]
        assert not hasattr(controller, name) and hasattr(controller, new)
        with pytest.raises(AttributeError, match=f"'{name}': it is '{row.new}' now"):
            getattr(controller, name)
    with pytest.raises(AttributeError, match=r"no attribute 'nothing'$"):
        controller.nothing  # type: ignore[attr-defined]  # noqa: B018


def test_a_name_that_never_was_gives_pythons_own_error() -> None:
    with pytest.raises(ImportError, match="cannot import name 'Nothing'"):
        exec("from ghc_controller import Nothing")
    with pytest.raises(ModuleNotFoundError, match=r"No module named 'ghc_controller\.nothing'"):
        importlib.import_module("ghc_controller.nothing")
    with pytest.raises(ImportError, match=r"cannot import name 'nothing'"):
        exec("from ghc_controller.tasks import nothing")


@pytest.mark.parametrize("row", rows(Kind.FIELD), ids=lambda row: row.old)
def test_an_old_field_in_python_and_in_a_file(tmp_path: Any, row: Renamed) -> None:
    names = {entry.name for entry in flat(ControllerParameters)}
    assert row.new in names and row.old not in names
    with pytest.raises(ConfigurationError, match=rf"{row.old}: it is '{row.new}' now"):
        ghc.Settings.of(**{row.old: 1.0})
    values = yaml.safe_load(find_scenario("priority_switching").read_text(encoding="utf-8"))
    values["parameters"] = {"controller": {row.old: 1.0}}
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump(values), encoding="utf-8")
    with pytest.raises(
        ConfigurationError, match=rf"parameters.controller.{row.old}: it is '{row.new}' now"
    ):
        load_scenario(str(file))


@pytest.mark.parametrize("row", rows(Kind.FIELD), ids=lambda row: row.old)
def test_an_old_parameter_of_a_node(start_node: Any, row: Renamed) -> None:
    arguments = ("--ros-args", "-p", "robot:=kuka_lwr", "-p", f"{row.old}:=1.0")
    node = start_node("ghc_controller", "controller", *arguments)
    assert node.wait(60.0) == 2
    assert f"parameter '{row.old}': it is '{row.new}' now" in node.output


@pytest.mark.parametrize("row", rows(Kind.EXECUTABLE), ids=lambda row: row.old)
def test_an_old_executable(row: Renamed) -> None:
    assert find_executable(*row.new.split()).is_file()
    with pytest.raises(GhcError, match=f"it is '{row.new}' now"):
        find_executable(*row.old.split())


def test_the_document_has_the_tables_as_they_are() -> None:
    text = DOCUMENT.read_text(encoding="utf-8")
    assert rendered(text) == text, "run: python docs/migration_tables.py"
    assert "docs/migration.md" in (ROOT / "README.md").read_text(encoding="utf-8")
