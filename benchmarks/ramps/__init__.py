"""Ramps of priorities and sweeps of states, for studies."""
