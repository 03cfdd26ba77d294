"""A plan of reachable targets begins where the robot is: no state that cannot be true does."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.ros.conversions.states import read_joint_state
from ghc_controller.ros.reachable.node import ReachableTargetsNode
from ghc_controller.ros.rejections import Rejections
from ghc_controller.ros.wire.joint_state import JointStateDecoder, JointStateEncoder
from ghc_controller.ros.wire.joint_state_reader import JointStateReader
from ghc_controller.ros.wire.timeline import Timeline
from ghc_controller.safety.plausibility import StatePlausibility
from ghc_controller.types import RobotState

PERIOD_NS = 20_000_000  # [ns]


@pytest.mark.parametrize("forged", [1e3, 1e300])
@pytest.mark.parametrize("first", [True, False])
def test_a_state_that_cannot_be_true_begins_no_plan(forged: float, first: bool) -> None:
    model = ghc.load_robot("kuka_lwr").model
    names, seen = model.joint_names, list[float]()

    def plan(state: RobotState) -> tuple[()]:
        seen.append(float(state.q[0]))
        return ()

    node: Any = ReachableTargetsNode.__new__(ReachableTargetsNode)
    warning: Callable[[str], None] = lambda _: None  # noqa: E731
    node.node = SimpleNamespace(get_logger=lambda: SimpleNamespace(warning=warning))
    node._decoder, node._reader = JointStateDecoder(read_joint_state), JointStateReader(names)
    node._plausibility = StatePlausibility(names, model.limits)
    node._timeline, node._rejections = Timeline(), Rejections()
    node._reference = SimpleNamespace(plan=plan, reset=lambda: None)
    node._period_ns, node._due_ns = PERIOD_NS, 0
    node._floating, node._base = False, None
    encoder, v = JointStateEncoder(names, ""), np.zeros(7)
    for k in range(5):
        q = forged if k == (0 if first else 2) else 0.3
        node._on_state(encoder.encode(k * PERIOD_NS, v, np.full(7, q), v))
    assert seen == [0.3] * 4
    assert sum(node._rejections.counts.values()) == 1
