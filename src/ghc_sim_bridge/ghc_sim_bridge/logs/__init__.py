"""Logs of a run: full-rate log and series of controller states."""
