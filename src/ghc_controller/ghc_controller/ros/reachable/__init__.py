"""The node that turns target streams into references (docs/reachable_targets.md)."""
