"""What a controller is asked for, and what it says of its steps; the loop is controller.py."""
