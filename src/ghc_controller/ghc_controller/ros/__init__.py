"""The rim: nodes, parameters and messages. Only this folder imports ROS."""
