"""What a step and a report say."""
