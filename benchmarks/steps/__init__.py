"""Time per control step: `make bench`."""
