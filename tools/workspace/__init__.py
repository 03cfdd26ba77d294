"""The set-up: from a fresh clone to a workspace that runs, with the standard library alone.

`python3 -m tools.workspace` (what `make setup` calls) makes the virtual environment, installs the
locked packages, builds the messages and installs the Python packages. Each step has a stamp that
holds a hash of its inputs, so a step runs only when these changed or when it was interrupted.
"""
