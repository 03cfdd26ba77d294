"""Planned bounds of one constraint over a horizon."""
