"""Faults injected into running nodes over DDS, evaluated by a passive monitor."""
