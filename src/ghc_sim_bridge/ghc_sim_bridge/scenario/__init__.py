"""Scenario files, and the plan of a run."""
