"""Control problems of recorded states of every scenario."""
