"""Every warning of a rejection ends with what the node does now."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import ghc_controller
import ghc_mpc_constraints
from ghc_controller.ros.rejections import BRIDGE, CONTROLLER, GENERATOR, warning

# Calls with a field that is written out, such as reject(f"{STATES}.stamp", ...): where it begins.
_FIELD = re.compile(r"[._]reject\(\s*f?\"([a-z_/]+)")


@pytest.mark.parametrize(
    ("package", "consequences"),
    [(ghc_controller, CONTROLLER), (ghc_mpc_constraints, GENERATOR)],
)
def test_fields_of_the_sources_have_a_consequence(
    package: object, consequences: dict[str, str]
) -> None:
    folder = Path(str(package.__file__)).parent / "ros"  # type: ignore[attr-defined]
    found = {
        field for path in folder.rglob("*.py") for field in _FIELD.findall(path.read_text("utf-8"))
    }
    assert found
    for field in found:
        assert any(field.startswith(start) for start in consequences), field


@pytest.mark.parametrize(
    ("field", "reason", "said"),
    [
        ("odom.stamp", "1 s given", "odom.stamp: 1 s given; the state of its stamp"),
        (
            "joint_states.velocity",
            "joint_states.velocity: 9 given",
            "joint_states.velocity: 9 given; this state is not answered",
        ),
        ("contacts/tool", "no WrenchStamped", "contacts/tool: no WrenchStamped; the state of"),
        ("constraints/preview/contact_forces", "nan given", "the previous plan stays active"),
    ],
)
def test_a_warning_says_its_field_once_and_what_follows(
    field: str, reason: str, said: str
) -> None:
    text = warning(field, reason, CONTROLLER)
    assert said in text
    assert text.count(field) == 1


def test_what_is_used_in_part_or_believed_has_no_such_words() -> None:
    left_out = warning("constraints/preview/x.left_out", "unknown contact 'heel'", CONTROLLER)
    assert left_out == "constraints/preview/x.left_out: unknown contact 'heel'"
    jump = warning("odom.pose.position.jump", "odom.pose.position: moved by 1 m", CONTROLLER)
    assert jump == "odom.pose.position: moved by 1 m"
    assert "the robot is held" in warning("effort", "joint_1 is nan", BRIDGE)
