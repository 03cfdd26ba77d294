"""The arm as data: URDF, robot.yaml, a scene and a scenario."""
