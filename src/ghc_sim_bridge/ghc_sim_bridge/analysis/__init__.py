"""Numbers from logs: errors, events, standing, metrics."""
