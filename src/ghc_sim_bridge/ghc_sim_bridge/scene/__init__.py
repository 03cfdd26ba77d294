"""Scene files: what a simulation adds to a robot."""
