"""Serialized messages: CDR read and written without message objects, at the control rate."""
