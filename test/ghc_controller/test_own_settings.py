"""A formulation brings settings of its own: set in Python, YAML and ROS like the others."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

import ghc_controller as ghc
from ghc_controller.errors import ConfigurationError, InvalidValue
from ghc_controller.formulations import FORMULATIONS, make_formulation
from ghc_controller.formulations.cascade.cascade import Cascade
from ghc_controller.ros.node_parameters import ParameterFields
from ghc_controller.ros.parameters import ControllerParameters
from ghc_controller.schema.declared import check, declared, flat_values
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.schema.record import known_names, read


@dataclass(frozen=True, slots=True)
class OwnSettings:
    """Of the formulation below."""

    softness: float = declared("of levels", 0.5, unit="-", domain=POSITIVE)
    patient: bool = declared("wait", False)

    def __post_init__(self) -> None:
        check(self)


@pytest.fixture(autouse=True)
def formulation(monkeypatch: pytest.MonkeyPatch) -> None:
    """`mine`: the default formulation with settings of its own."""
    monkeypatch.setattr(FORMULATIONS, "_registered", dict(FORMULATIONS._registered))

    @ghc.register_formulation
    class Mine(Cascade):
        name = "mine"
        own_settings = OwnSettings

        def __init__(
            self, settings: ghc.FormulationSettings, solver: ghc.QpSolver, own: OwnSettings
        ) -> None:
            super().__init__(settings, solver)
            self.own = own


def test_they_are_set_from_python() -> None:
    settings = ghc.Settings.of(formulation="mine", softness=2, regularization=0.1)
    assert settings.own == OwnSettings(softness=2.0)
    assert settings.optimization.regularization == 0.1
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"), settings)
    assert controller.formulation.own == OwnSettings(softness=2.0)  # type: ignore[attr-defined]
    usual = make_formulation("mine")
    assert usual.own == OwnSettings()  # type: ignore[attr-defined]


def test_they_are_set_in_the_file_of_a_robot_and_changed_by_a_parameter(tmp_path: Path) -> None:
    source = ghc.load_robot("kuka_lwr")
    text = source.path.read_text(encoding="utf-8")
    text = text.replace("urdf: kuka_lwr.urdf", f"urdf: {source.urdf}")
    file = tmp_path / "robot.yaml"
    file.write_text(text + "\nsettings: {formulation: mine, softness: 3.0, patient: true}\n")
    settings = ghc.Settings.for_robot(ghc.load_robot(file))
    assert settings.own == OwnSettings(3.0, True)
    base = ControllerParameters(settings=settings)
    given = {"robot": "r", "softness": 4}
    assert set(given) <= set(known_names(ControllerParameters, given, base))
    node = read(ParameterFields(given), ControllerParameters, base=base)
    assert node.settings.own == OwnSettings(4.0, True)
    values = {entry.name: value for entry, value in flat_values(node)}
    assert (values["softness"], values["patient"]) == (4.0, True)


def test_another_formulation_has_none_of_them() -> None:
    assert ghc.Settings().own is None
    assert "softness" not in set(known_names(ghc.Settings, {"formulation": "hqp"}))
    with pytest.raises(ConfigurationError, match="softness: unknown field"):
        ghc.Settings.of(formulation="hqp", softness=2.0)
    with pytest.raises(InvalidValue, match=r"'hqp': own settings OwnSettings\(.*none"):
        make_formulation("hqp", own=OwnSettings())
    with pytest.raises(InvalidValue, match=r"'mine': own settings 3 given, OwnSettings"):
        make_formulation("mine", own=3)


def test_they_are_checked_as_declared() -> None:
    with pytest.raises(ConfigurationError, match=r"softness: a number above 0 expected, -1"):
        ghc.Settings.of(formulation="mine", softness=-1)
    with pytest.raises(ConfigurationError, match=r"patient: true or false expected, 1 given"):
        ghc.Settings.of(formulation="mine", patient=1)
