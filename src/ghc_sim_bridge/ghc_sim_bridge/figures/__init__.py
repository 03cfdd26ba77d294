"""Figures and films from analyses."""
