"""Installs the simulator bridge, the experiments, the recorder and the viewer."""

from setuptools import find_packages, setup

package_name = "ghc_sim_bridge"

setup(
    name=package_name,
    version="0.1.0",
    description="MuJoCo behind ROS 2 topics, and the experiments that run on them",
    license="Apache-2.0",
    maintainer="GHC control stack maintainers",
    maintainer_email="maintainers@ghc-control.example",
    packages=find_packages(),
    package_data={package_name: ["py.typed", "scene/data/**/*", "scenario/data/**/*"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package_name}"]),
        (f"share/{package_name}", ["package.xml"]),
    ],
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "sim_bridge = ghc_sim_bridge.ros.bridge_node:main",
            "experiment = ghc_sim_bridge.programs.experiment:main",
            "recorder = ghc_sim_bridge.ros.recorder_node:main",
            "replay = ghc_sim_bridge.ros.replay_node:main",
            "repair_bag = ghc_sim_bridge.programs.repair_bag:main",
            "display_publisher = ghc_sim_bridge.ros.display.node:main",
            "viewer = ghc_sim_bridge.ros.viewer_node:main",
            "campaign = ghc_sim_bridge.programs.campaign:main",
            "paper = ghc_sim_bridge.programs.paper.paper:main",
            "studies = ghc_sim_bridge.programs.studies.main:main",
            "picture = ghc_sim_bridge.programs.picture:main",
            "check_robot = ghc_sim_bridge.programs.check_robot:main",
        ]
    },
)
