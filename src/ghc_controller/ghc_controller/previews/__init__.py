"""What a generator plans for one constraint over a horizon."""
