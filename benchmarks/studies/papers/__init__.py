"""Studies beside the figures of papers."""
