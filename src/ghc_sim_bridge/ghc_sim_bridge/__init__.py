"""MuJoCo behind ROS 2 topics, and the experiments that run on them."""
