"""What the process of a node asks of the operating system."""
