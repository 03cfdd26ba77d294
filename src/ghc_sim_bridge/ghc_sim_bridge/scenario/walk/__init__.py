"""Walking: footsteps and the motion of the center of mass."""
