"""Installs the controller: a plain Python library and the ROS 2 executables."""

from setuptools import find_packages, setup

package_name = "ghc_controller"

setup(
    name=package_name,
    version="0.1.0",
    description="Generalized Hierarchical Control: tasks, priorities, formulations and the node",
    license="Apache-2.0",
    maintainer="GHC control stack maintainers",
    maintainer_email="maintainers@ghc-control.example",
    packages=find_packages(),
    package_data={package_name: ["py.typed", "robot/data/**/*"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package_name}"]),
        (f"share/{package_name}", ["package.xml"]),
    ],
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "controller = ghc_controller.ros.controller_node:main",
            "reachable_targets = ghc_controller.ros.reachable.node:main",
            "transition = ghc_controller.ros.transition:main",
            "new_robot = ghc_controller.robot.first_files.new_robot:main",
        ]
    },
)
