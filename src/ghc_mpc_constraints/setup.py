"""Installs the constraint generators: a plain Python library and two nodes."""

from setuptools import find_packages, setup

package_name = "ghc_mpc_constraints"

setup(
    name=package_name,
    version="0.1.0",
    description="Predictive generators of constraints: contact force bounds, obstacle motion",
    license="Apache-2.0",
    maintainer="GHC control stack maintainers",
    maintainer_email="maintainers@ghc-control.example",
    packages=find_packages(),
    package_data={package_name: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package_name}"]),
        (f"share/{package_name}", ["package.xml"]),
    ],
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "contact_force_bounds = ghc_mpc_constraints.ros.contact_force_bounds_node:main",
            "obstacle_bounds = ghc_mpc_constraints.ros.obstacle_bounds_node:main",
        ]
    },
)
