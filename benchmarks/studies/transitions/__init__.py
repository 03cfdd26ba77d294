"""Studies of transitions between orders."""
