"""A robot in MuJoCo's MJCF as a URDF, from the model that MuJoCo itself compiles."""
