"""Random input for every parser, codec and loader, the logic of transitions, and nodes."""
