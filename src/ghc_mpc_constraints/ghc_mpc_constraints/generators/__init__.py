"""The constraint generators: one file each, found by their registered names."""
