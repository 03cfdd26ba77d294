"""A page in the browser with sliders for targets, hierarchy and gains, on this machine only."""
