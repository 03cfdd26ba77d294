"""Results on disk: one small JSON per case and method."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from benchmarks.compare.jobs import Job, job_digest

Results = Mapping[str, Mapping[str, Mapping[str, Any]]]  # case -> method -> result


def path_of(folder: Path, job: Job) -> Path:
    """File of a job."""
    return folder / job.case / f"{job.method}.json"


def write(folder: Path, job: Job, result: Mapping[str, Any]) -> None:
    """Write the result of a job atomically."""
    path = path_of(folder, job)
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(result, indent=1, sort_keys=True, allow_nan=False)
    part = path.with_suffix(".part")
    part.write_text(text + "\n", encoding="utf-8")
    part.replace(path)


def is_done(folder: Path, job: Job) -> bool:
    """Whether the result of a job exists for the current sources."""
    path = path_of(folder, job)
    if not path.is_file():
        return False
    stored = json.loads(path.read_text(encoding="utf-8"))
    return stored["quick"] == job.quick and stored["sources"] == job_digest(job)


def load(folder: Path) -> Results:
    """All results in a folder, in the order of cases and methods."""
    from benchmarks.compare.jobs import all_jobs

    found: dict[str, dict[str, Any]] = {}
    for job in all_jobs():
        path = path_of(folder, job)
        if path.is_file():
            text = path.read_text(encoding="utf-8")
            found.setdefault(job.case, {})[job.method] = json.loads(text)
    return found
