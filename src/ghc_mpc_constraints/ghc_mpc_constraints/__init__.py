"""Constraints that jump become bounds that move: previews over a receding horizon."""
