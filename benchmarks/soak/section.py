"""The parts of documents that `make soak` writes."""

from __future__ import annotations

from benchmarks.sections import Section

GENERATORS = Section(
    "soak: written by `make soak ARGS=--write-docs`", before="## What to keep in mind"
)
STACK = Section(
    "stack: written by `make soak ARGS='--stack --write-docs'`", before="## Not in this table"
)
