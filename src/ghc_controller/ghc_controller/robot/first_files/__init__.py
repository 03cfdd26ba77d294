"""First robot.yaml, scene and scenario of a robot that only has a URDF."""
