"""A robot: its description in robot.yaml, and the robots that come with the package."""
