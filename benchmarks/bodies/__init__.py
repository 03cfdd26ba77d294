"""Bodies that keep their distances: random targets, and margins that are switched on."""
