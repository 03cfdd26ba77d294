"""Independent runs in parallel, with a progress bar."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

from tqdm import tqdm

C = TypeVar("C")
R = TypeVar("R")


def run_all(title: str, run: Callable[[C], R], cases: Sequence[C], workers: int) -> list[R]:
    """Results in the order of the cases; each worker is a separate process with one thread."""
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # read by the libraries of the workers when they load
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, context) as pool:
        return list(tqdm(pool.map(run, cases), title, len(cases), unit="run"))
