"""Robots by name or path: what else is given is told apart in words."""

from __future__ import annotations

from typing import Any

import pytest

import ghc_controller as ghc
from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.library import load_robot


def test_a_robot_where_its_name_belongs_is_named_in_a_line() -> None:
    robot: Any = load_robot("kuka_lwr")
    for call in (load_robot, ghc.Controller.for_robot):
        with pytest.raises(ConfigurationError, match=r"^a Robot given, .* Controller\(robot\)"):
            call(robot)


@pytest.mark.parametrize("given", [None, 3, ["kuka_lwr"]])
def test_what_is_no_name_is_named_by_its_type(given: Any) -> None:
    with pytest.raises(ConfigurationError, match=f"^a {type(given).__name__} given, the name"):
        load_robot(given)


def test_a_name_where_a_robot_belongs_names_the_way_to_one() -> None:
    name: Any = "kuka_lwr"
    with pytest.raises(ConfigurationError, match=r"'kuka_lwr' given, .*Controller\.for_robot"):
        ghc.Controller(name)
