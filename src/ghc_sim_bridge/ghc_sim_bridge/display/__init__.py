"""What other programs need to draw the robot: its description, transforms of its links, marks."""
