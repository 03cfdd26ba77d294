"""What a run leaves: full-rate log and series of controller states."""
