"""`make study`: problem sets that test properties of the formulations; results are committed.

One module of benchmarks/studies per study. Results go to docs/study/<name>.json, and docs/study.md
is written from all results that are present. A quick run goes to results/study instead.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = all studies run, 1 = something is missing, reported in one line."""
    for name in _THREADS:  # before NumPy is imported
        os.environ.setdefault(name, "1")
    import ghc_controller as ghc
    from benchmarks.studies import load_studies
    from benchmarks.study_results import store, write_document
    from tools.workspace.errors import SetupError

    studies = load_studies()
    options = _parser(list(studies)).parse_args(arguments)
    folder = options.output or ROOT / ("results/study" if options.quick else "docs/study")
    try:
        for name in [] if options.document else options.names or list(studies):
            study = studies[name]
            formulations = tuple(options.formulation) or study.FORMULATIONS
            print(f"study {name}: {', '.join(formulations)}", flush=True)
            begin = time.monotonic()
            result = store(folder, name, study.run(options.quick, formulations))
            print(f"{study.table(result)}\n({time.monotonic() - begin:.0f} s)\n", flush=True)
    except (ghc.GhcError, SetupError) as error:
        print(f"study: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("study: interrupted; the finished studies were written", file=sys.stderr)
        return 130
    finally:
        write_document(folder, studies)
    return 0


def _parser(names: Sequence[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="study", description=__doc__.splitlines()[0])
    parser.add_argument(
        "names", nargs="*", choices=[[], *names], metavar="name", help=", ".join(names)
    )
    parser.add_argument("--quick", action="store_true", help="very small, to see that it works")
    parser.add_argument(
        "--document", action="store_true", help="run nothing, write docs/study.md anew"
    )
    parser.add_argument(
        "--formulation",
        action="append",
        default=[],
        metavar="NAME",
        help="only this formulation (may be repeated); results of the others are kept",
    )
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder of the results")
    return parser


if __name__ == "__main__":
    sys.path[0] = str(ROOT)  # instead of this folder: its modules are those of a package
    sys.exit(main())
