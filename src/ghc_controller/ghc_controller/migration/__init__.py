"""Names of earlier versions; using one raises an error with the new name."""
