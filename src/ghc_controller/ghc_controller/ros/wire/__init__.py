"""Bytes on the wire: CDR read and written without message objects, at the control rate."""
