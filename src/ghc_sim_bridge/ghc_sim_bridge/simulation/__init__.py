"""The simulated robot and its environment in MuJoCo."""
