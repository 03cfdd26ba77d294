#!/bin/bash
# Runs a command in the shell environment of the workspace: ROS, the virtual environment, install/.
set -e
cd /workspace
source /opt/ros/jazzy/setup.bash
source .venv/bin/activate
source install/setup.bash
exec "$@"
