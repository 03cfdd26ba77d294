"""ROS interface: nodes, parameters and messages. Only this folder imports ROS."""

from ghc_controller.ros.wire.middleware import refuse_missing

refuse_missing()
