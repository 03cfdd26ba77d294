"""Where jobs run: the cores of this machine, or those of a dask cluster."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from typing import Any

from benchmarks.compare.jobs import Job, run_job


@contextmanager
def workers(cluster: str = "", count: int = 0) -> Iterator[Executor]:
    """Executor of this machine with `count` processes (0 = one per core), or of a cluster.

    The workers of a cluster need this repository at the same commit, with its environment active
    and its root in PYTHONPATH.

    Raises:
        ModuleNotFoundError: a cluster is given, and `distributed` is not installed.
        OSError: nothing answers at the address.
    """
    if cluster:
        from distributed import Client

        with Client(cluster, set_as_default=False) as client:
            yield client.get_executor(pure=False)
        return
    # A process of its own for every worker: threads of a library do not survive a fork.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(count or os.cpu_count(), mp_context=context) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def run_jobs(executor: Executor, jobs: Sequence[Job]) -> Iterator[tuple[Job, dict[str, Any]]]:
    """Yields results as they are completed; re-raises errors of jobs."""
    futures = {executor.submit(run_job, job): job for job in jobs}
    for future in as_completed(futures):
        yield futures[future], future.result()
