"""What users do with the project: their robots, and its live viewer."""
