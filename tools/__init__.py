"""Tools of this repository; run from its root as `python3 -m tools.NAME`."""
