"""Conversions between messages and values."""
