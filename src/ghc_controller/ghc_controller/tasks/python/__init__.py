"""Task kinds that are measured in Python; those of `tasks/` are mostly measured by the core."""
