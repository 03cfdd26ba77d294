"""Requests from the command line: sent once a controller is found, and followed until done."""
