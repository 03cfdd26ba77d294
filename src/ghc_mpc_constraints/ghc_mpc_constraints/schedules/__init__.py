"""Schedules of planners: bounds with the times from which they apply."""
