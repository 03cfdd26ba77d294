"""What tasks follow: trajectories of references, and which of them is in force."""
