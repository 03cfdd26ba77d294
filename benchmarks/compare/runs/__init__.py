"""Closed loops of the cases, and what is measured in them."""
