"""Task references: trajectories, and which of them is active."""
