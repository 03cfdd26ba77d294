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
    package_data={package_name: ["py.typed", "scenes/**/*", "scenarios/**/*"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package_name}"]),
        (f"share/{package_name}", ["package.xml"]),
    ],
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "sim_bridge = ghc_sim_bridge.sim_bridge_node:main",
            "experiment = ghc_sim_bridge.experiment:main",
            "recorder = ghc_sim_bridge.recorder_node:main",
            "viewer = ghc_sim_bridge.viewer_node:main",
            "campaign = ghc_sim_bridge.campaign:main",
            "paper = ghc_sim_bridge.paper:main",
            "picture = ghc_sim_bridge.picture:main",
        ]
    },
)
