"""Constraints that are general rows: one scalar that is kept in a range, or below a rate."""
