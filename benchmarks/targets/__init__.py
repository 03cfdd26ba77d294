"""Target streams, and closed loops under limits."""
