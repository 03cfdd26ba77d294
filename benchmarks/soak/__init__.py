"""Memory of the generator nodes over time: `make soak`."""
