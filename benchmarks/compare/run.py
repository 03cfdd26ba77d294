"""`make compare`: every formulation on every case through the library; docs/comparison.md.

Results go to docs/comparison, one small file per case and formulation; what stands there of the
same sources is not run again. A quick run goes to results/comparison.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = all results complete, 1 = something is missing (one line), 130 = Ctrl-C."""
    for name in _THREADS:  # before NumPy is imported, also by the workers
        os.environ.setdefault(name, "1")
    import ghc_controller as ghc
    from benchmarks.compare.pages.page import write_page
    from benchmarks.compare.store import load
    from tools.workspace.errors import SetupError

    options = _options(arguments)
    default = "results/comparison" if options.quick else "docs/comparison"
    folder = options.output or ROOT / default
    status = 0
    try:
        if not options.document:
            _run(options, folder)
    except (ghc.GhcError, SetupError, OSError) as error:
        print(f"compare: {error}", file=sys.stderr)
        status = 1
    except KeyboardInterrupt:
        print("compare: interrupted; finished results are kept", file=sys.stderr)
        status = 130
    results = load(folder)
    if results:
        print(f"compare: {write_page(results, folder)}", file=sys.stderr)
    return status


def _run(options: argparse.Namespace, folder: Path) -> None:
    from tqdm import tqdm

    from benchmarks.compare import store
    from benchmarks.compare.jobs import all_jobs, job_digest
    from benchmarks.compare.workers import run_jobs, workers
    from benchmarks.models import install_cluster, install_model
    from ghc_controller.errors import InvalidValue

    install_model("icub-models")
    if options.cluster:
        install_cluster()
    jobs = list(all_jobs(options.case, options.formulation, options.quick))
    left = [job for job in jobs if options.again or not store.is_done(folder, job)]
    print(f"compare: {len(jobs) - len(left)} of {len(jobs)} are done", file=sys.stderr)
    if not left:
        return
    with (
        workers(options.cluster, options.workers) as executor,
        tqdm(total=len(left), unit="run", mininterval=1.0) as bar,
    ):
        for job, result in run_jobs(executor, left):
            if result["sources"] != job_digest(job):
                raise InvalidValue(
                    f"{job.case}, {job.method}: a worker has other sources than this machine; "
                    "bring its repository to the same commit and start it again"
                )
            store.write(folder, job, result)
            bar.set_postfix_str(f"{job.case}, {job.method}", refresh=False)
            bar.update()


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    import ghc_controller as ghc
    from benchmarks.compare.cases import CASES

    parser = argparse.ArgumentParser(prog="compare", description=(__doc__ or "").splitlines()[0])
    for name, known in (("--case", CASES), ("--formulation", ghc.FORMULATIONS)):
        parser.add_argument(
            name,
            action="append",
            choices=list(known),
            default=[],
            metavar="NAME",
            help="only this one (may be repeated); results of the others are kept",
        )
    parser.add_argument("--quick", action="store_true", help="very small, to see that it works")
    parser.add_argument("--again", action="store_true", help="also what is done")
    parser.add_argument("--document", action="store_true", help="run nothing, write the page anew")
    parser.add_argument("--workers", type=int, default=0, metavar="N", help="0 = one per core")
    parser.add_argument("--cluster", default="", metavar="tcp://...", help="dask scheduler")
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder of the results")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.path[0] = str(ROOT)  # instead of this folder: its modules are those of a package
    sys.exit(main())
