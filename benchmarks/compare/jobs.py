"""One job: a method on a case, here or on another machine."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from functools import cache
from inspect import getmodule
from typing import NamedTuple

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


class Job(NamedTuple):
    """Names of case and method, and whether it is very small."""

    case: str
    method: str
    quick: bool = False


def run_job(job: Job) -> dict[str, object]:
    """Result of a job with the digest of the sources that it was run with.

    A case that the formulation rejects gives {"rejected": reason}.
    """
    for name in _THREADS:  # before NumPy is imported, where it is not yet
        os.environ.setdefault(name, "1")
    import ghc_controller as ghc
    from benchmarks.code_version import commit
    from benchmarks.compare.cases import CASES
    from benchmarks.study_results import rounded

    case = CASES[job.case]
    try:
        result = case.run(case.methods[job.method], job.quick)
    except ghc.GhcError as error:
        result = {"rejected": str(error)}
    origin = {"sources": job_digest(job), "commit": commit()}
    return rounded(result) | origin | {"quick": job.quick}


@cache
def job_digest(job: Job) -> str:
    """Digest of the sources of case and formulation."""
    import ghc_controller as ghc
    from benchmarks.compare.cases import CASES
    from benchmarks.compare.digest import digest

    case = CASES[job.case]
    method = case.methods[job.method]
    run = getattr(case.run, "func", case.run)  # below a partial
    parts = [getmodule(part) for part in (run, ghc.FORMULATIONS[method.formulation])]
    numbers = f"{getattr(case.run, 'keywords', {})} {dict(method.changes)}"
    return digest([module.__name__ for module in parts if module is not None], numbers)


def all_jobs(
    cases: Iterable[str] = (), formulations: Iterable[str] = (), quick: bool = False
) -> Iterator[Job]:
    """Jobs of these cases and formulations, all of them where none is named."""
    from benchmarks.compare.cases import CASES

    chosen, wanted = set(cases), set(formulations)
    for case in CASES.values():
        for method in case.methods.values():
            if (not chosen or case.name in chosen) and (
                not wanted or method.formulation in wanted
            ):
                yield Job(case.name, method.name, quick)
