"""Small dense factorizations and rotations."""
