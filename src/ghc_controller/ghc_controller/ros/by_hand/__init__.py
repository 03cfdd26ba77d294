"""Requests by hand: sent once a controller shows that it is there, and followed to their end."""
