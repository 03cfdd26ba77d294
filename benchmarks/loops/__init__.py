"""Round trips per second over DDS: `make bench`."""
