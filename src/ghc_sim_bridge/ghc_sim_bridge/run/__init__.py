"""Processes of a run: domains, CPUs, progress, interrupts."""
