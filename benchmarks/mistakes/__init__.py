"""Plausible mistakes of users, each done for real, and the message that it gets."""
