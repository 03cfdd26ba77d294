"""The Rerun viewer: live and from a recording."""
