"""Conversion of MuJoCo's MJCF to URDF, from the model compiled by MuJoCo."""
