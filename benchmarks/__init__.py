"""`make bench`: time per control step, and round trips per second over DDS."""
