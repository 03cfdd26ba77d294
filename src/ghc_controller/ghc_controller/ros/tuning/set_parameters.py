"""Parameters of the controller node that change while it runs: `ros2 param set`.

A change is checked at once and rejected with a reason; accepted values are blended in from the
next state on (`control/tuning.py`).
"""

from __future__ import annotations

from collections.abc import Sequence

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from ghc_controller.control.change_checks import CHOICES
from ghc_controller.control.dials import LIMITS, WEIGHTS, gain_names
from ghc_controller.controller import Controller
from ghc_controller.errors import GhcError

SETTINGS_THAT_CHANGE = frozenset(("tuning_duration", *WEIGHTS, *LIMITS, *CHOICES))
_UNITS = {"stiffness": "1/s^2", "damping": "1/s"}
_LARGEST_GAIN = 1e6  # [1/s^2] or [1/s] for sliders; far above what a control period allows


class ParameterTuning:
    """Declares the gains of every task as parameters, and handles parameter changes."""

    def __init__(self, node: Node, controller: Controller) -> None:
        self._controller = controller
        for name in gain_names(controller.robot):
            _, task, gain = name.split(".")
            stack = controller.stack
            values = getattr(stack.tasks[controller.robot.task_names.index(task)], gain)
            descriptor = ParameterDescriptor(
                description=f"[{_UNITS[gain]}] of task '{task}': one number, or one per row",
                additional_constraints="≥ 0",
                floating_point_range=[FloatingPointRange(from_value=0.0, to_value=_LARGEST_GAIN)],
                dynamic_typing=True,
            )
            node.declare_parameter(name, values.tolist(), descriptor)
        node.add_on_set_parameters_callback(self._set)

    def _set(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        ours = (*SETTINGS_THAT_CHANGE, *self._controller.tuning.names)
        values = {one.name: one.value for one in parameters if one.name in ours}
        if not values:
            return SetParametersResult(successful=True)
        try:
            change = self._controller.tuning.check(values)
        except GhcError as error:
            return SetParametersResult(successful=False, reason=str(error))
        except Exception as error:  # of another package; raised here, it would end the node
            reason = f"{', '.join(values)}: {type(error).__name__}: {error}"
            return SetParametersResult(successful=False, reason=reason)
        self._controller.tuning.begin(change)
        return SetParametersResult(successful=True)
