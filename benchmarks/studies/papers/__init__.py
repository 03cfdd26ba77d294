"""Studies that reproduce figures of papers."""
