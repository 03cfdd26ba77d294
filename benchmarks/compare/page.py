"""The page docs/comparison.md."""

from pathlib import Path
from typing import Any


def write_page(results: Any, folder: Path) -> Path:
    assert results
    return folder
