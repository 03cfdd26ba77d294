"""`make kinematics`: T1 to T20 of gn_qn_2018; results in docs/kinematics, document docs/gn_qn.md.

What was not run is kept from the results that are there, provided that the lengths are the same.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
_QUICK_STEPS = 60


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = everything run, 1 = something is missing, reported in one line."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):  # before NumPy is imported
        os.environ.setdefault(name, "1")
    import ghc_controller as ghc
    from benchmarks.kinematics.document import write_document
    from tools.workspace.errors import SetupError

    options = _parser().parse_args(arguments)
    folder = options.output or ROOT / ("results" if options.quick else "docs")
    path = folder / "kinematics" / "results.json"
    results = _stored(path, options.quick)
    try:
        if not options.document:
            for test in options.tests or range(1, 21):
                _run_test(test, options.variant, options.quick, results)
                _store(results, path)
    except (ghc.GhcError, SetupError) as error:
        print(f"kinematics: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("kinematics: interrupted; the finished tests were written", file=sys.stderr)
        return 130
    write_document(results, folder)
    return 0


def _parser() -> argparse.ArgumentParser:
    from benchmarks.kinematics.variants import VARIANTS

    parser = argparse.ArgumentParser(prog="kinematics", description=__doc__.splitlines()[0])
    parser.add_argument("tests", nargs="*", type=int, choices=[[], *range(1, 21)], metavar="N")
    parser.add_argument("--variant", action="append", default=[], choices=list(VARIANTS))
    parser.add_argument("--quick", action="store_true", help="very short, to see that it works")
    parser.add_argument("--document", action="store_true", help="run nothing, only write gn_qn.md")
    parser.add_argument(
        "--output", type=Path, metavar="DIR", help="folder of results and document"
    )
    return parser


def _stored(path: Path, quick: bool) -> dict[str, Any]:
    """Results so far: {"quick": ..., "T1": {variant: figures}, ..., "T20/10000": ...}."""
    if path.exists():
        results: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        if results["quick"] == quick:
            return results
    return {"quick": quick}


def _store(results: dict[str, Any], path: Path) -> None:
    from benchmarks.study_results import rounded

    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(rounded(results), sort_keys=True, allow_nan=False)
    path.write_text(text.replace('}, "', '},\n"') + "\n", encoding="utf-8")


def _run_test(test: int, chosen: Sequence[str], quick: bool, results: dict[str, Any]) -> None:
    from benchmarks.kinematics.humanoid_test import PERIODS, run_humanoid
    from benchmarks.kinematics.planar_tests import STEPS, planar_test, run_planar
    from benchmarks.kinematics.variants import HUMANOID, INEQUALITIES, VARIANTS

    able = HUMANOID if test == 20 else INEQUALITIES if test == 2 else tuple(VARIANTS)
    for name in (name for name in chosen or able if name in able):
        begin, settings = time.monotonic(), VARIANTS[name]
        if test == 20:
            for steps, period in PERIODS.items():
                length = _QUICK_STEPS if quick else steps
                figures = run_humanoid(settings, length, period)
                results.setdefault(f"T20/{steps}", {})[name] = figures
        else:
            figures = run_planar(planar_test(test, _QUICK_STEPS if quick else STEPS), settings)
            if test not in (1, 2) or name not in ("gn_qn", "dhqp", "adls", "gn"):
                del figures["trace"]
            results.setdefault(f"T{test}", {})[name] = figures
        shown = {k: v for k, v in figures.items() if k in ("sigma", "e1", "psi", "hand", "box_m")}
        print(f"T{test} {name}: {shown} ({time.monotonic() - begin:.0f} s)", flush=True)


if __name__ == "__main__":
    sys.path[0] = str(ROOT)
    sys.exit(main())
