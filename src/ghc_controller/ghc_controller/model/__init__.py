"""The model of a robot: kinematics and dynamics of one configuration, and joint limits."""
