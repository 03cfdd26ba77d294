"""Installs the constraint generators: a plain Python library and the node that runs them."""

from setuptools import find_packages, setup

package_name = "ghc_mpc_constraints"

setup(
    name=package_name,
    version="0.1.0",
    description="Predictive generators of constraints: contact forces, obstacles, limits",
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
            "generator = ghc_mpc_constraints.ros.generator_node:main",
            "contact_force_bounds = ghc_mpc_constraints.ros.generator_node:contact_force_bounds",
            "obstacle_bounds = ghc_mpc_constraints.ros.generator_node:obstacle_bounds",
        ]
    },
)
