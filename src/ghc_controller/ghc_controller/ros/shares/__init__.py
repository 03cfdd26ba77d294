"""The node by which priorities follow a distance (docs/interfaces.md)."""
