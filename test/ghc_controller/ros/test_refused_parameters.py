"""A change of parameters that raises is refused: the service of a node would end it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from rclpy.parameter import Parameter

from ghc_controller.ros.tuning.set_parameters import ParameterTuning


def test_what_a_formulation_of_another_package_raises_is_the_reason() -> None:
    begun: list[Any] = []

    def check(_: Any) -> None:
        raise ZeroDivisionError("a mistake")

    node: Any = ParameterTuning.__new__(ParameterTuning)
    tuning = SimpleNamespace(names=(), check=check, begin=begun.append)
    node._controller = SimpleNamespace(tuning=tuning)
    result = node._set([Parameter("formulation", value="mine")])
    assert not result.successful
    assert result.reason == "formulation: ZeroDivisionError: a mistake"
    assert not begun
