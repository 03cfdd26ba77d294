"""Shapes of a robot's bodies, and smooth distances between them."""
