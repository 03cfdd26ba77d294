"""`make compare`: every formulation on every case, and docs/comparison.md from the results."""
