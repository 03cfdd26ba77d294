"""Figures and animations from analyses."""
