"""What stops the set-up, told in one line."""

from __future__ import annotations


class SetupError(Exception):
    """Something that the user has to put right: the text says what and how."""
