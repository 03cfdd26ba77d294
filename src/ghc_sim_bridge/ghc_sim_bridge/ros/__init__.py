"""ROS interface: nodes, parameters and messages. Only this folder imports ROS."""

import ghc_controller.ros  # noqa: F401  rejects a middleware that is missing, before rclpy loads
