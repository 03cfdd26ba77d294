"""The thesis' studies of both generators, without a robot: figures 4.5 to 4.8 and 5.3 to 5.10."""
