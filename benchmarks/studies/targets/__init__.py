"""Studies of target streams: what a robot can follow, and how closely."""
