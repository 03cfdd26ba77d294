"""Installs the controller: the library with its compiled core, and the ROS 2 executables."""

import sys
from pathlib import Path

from setuptools import find_packages, setup

sys.path.insert(0, str(Path(__file__).resolve().parent))
from build_core import CORE, BuildCore

package_name = "ghc_controller"

setup(
    name=package_name,
    version="0.1.0",
    description="Generalized Hierarchical Control: tasks, priorities, formulations and the node",
    license="Apache-2.0",
    maintainer="GHC control stack maintainers",
    python_requires=">=3.11",
    # Without ROS; a workspace installs the versions of requirements/ instead.
    install_requires=["daqp", "numpy", "pin", "proxsuite", "pyyaml"],
    packages=find_packages(),
    package_data={
        package_name: [
            "py.typed",
            "robot/data/**/*",
            "ros/*.xml",
            "ros/steering/page.html",
            "core/*.pyi",
        ]
    },
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package_name}"]),
        (f"share/{package_name}", ["package.xml"]),
    ],
    ext_modules=[CORE],
    cmdclass={"build_ext": BuildCore},
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "controller = ghc_controller.ros.controller_node:main",
            "reachable_targets = ghc_controller.ros.reachable.node:main",
            "priority_share = ghc_controller.ros.shares.node:main",
            "transition = ghc_controller.ros.transition:main",
            "reference = ghc_controller.ros.by_hand.reference:main",
            "steer = ghc_controller.ros.steering.node:main",
            "tune = ghc_controller.ros.by_hand.tune:main",
            "new_robot = ghc_controller.robot.first_files.new_robot:main",
        ]
    },
)
