"""Anything into every parser, codec, loader, into the logic of transitions, and into nodes."""
