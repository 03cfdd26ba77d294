"""Horizons, integrator chains and the QPs that smooth bounds over them."""
