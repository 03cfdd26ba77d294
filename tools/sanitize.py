"""Build the core with sanitizers and run its tests and random calls under them: `make sanitize`.

AddressSanitizer finds reads and writes beyond an array or after its end, UBSan overflows and
misaligned or null accesses; Eigen's assertions on sizes are on. A copy of the library with this
build lies in build/sanitize, so that the installed core stays as it is. The first finding ends the
run.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

_BUILD = {  # the flags of a release hold no NDEBUG then, so that assertions stay
    "GHC_CMAKE_ARGS": "-DCMAKE_CXX_FLAGS_RELEASE=-O1",
    "CXXFLAGS": "-g1 -fno-omit-frame-pointer -fsanitize=address,undefined "
    "-fno-sanitize-recover=all",
}
_TESTS = (
    "test/ghc_controller/core",
    "test/ghc_controller/problem",
    "test/ghc_controller/hierarchy/test_projector.py",
    "test/ghc_controller/qp",
    "test/ghc_controller/test_bounded_time.py",
    "test/ghc_controller/test_step_at_rest.py",
)
_LIBRARIES = ("libasan.so", "libubsan.so")


def main() -> int:
    """0 when nothing was found; arguments are those of the random calls."""
    root = Path(__file__).resolve().parents[1]
    copy = root / "build" / "sanitize"
    _copy_library(root / "src" / "ghc_controller", copy)
    environment = dict(os.environ)
    if _build(copy, environment | _BUILD) != 0:
        return 1
    environment["PYTHONPATH"] = os.pathsep.join(
        [str(copy), str(root), environment.get("PYTHONPATH", "")]
    )
    environment |= {
        "LD_PRELOAD": " ".join(map(_library, _LIBRARIES)),
        "ASAN_OPTIONS": "detect_leaks=0:detect_odr_violation=0",  # Python keeps what it likes
        "PYTHONMALLOC": "malloc",  # else small arrays lie in blocks of Python's own
        "OMP_NUM_THREADS": "1",
    }
    where = "import ghc_controller.core.native as core; print(core.__file__)"
    found = subprocess.run(
        [sys.executable, "-c", where], env=environment, capture_output=True, text=True, check=True
    )
    assert Path(found.stdout.strip()).is_relative_to(copy), found.stdout
    pytest = ["-m", "pytest", "-q", "-p", "no:cacheprovider", *_TESTS]
    for command in (["-m", "benchmarks.fuzz.core_calls", *sys.argv[1:]], pytest):
        run = subprocess.run([sys.executable, *command], cwd=root, env=environment, check=False)
        if run.returncode != 0:
            return run.returncode
    return 0


def _copy_library(source: Path, copy: Path) -> None:
    """The sources without anything built; what CMake made before stays."""
    for path in copy.glob("ghc_controller*"):
        shutil.rmtree(path)
    copy.mkdir(parents=True, exist_ok=True)
    ignored = shutil.ignore_patterns("build", "*.so", "*.egg-info", "__pycache__")
    shutil.copytree(source, copy, ignore=ignored, dirs_exist_ok=True)


def _build(copy: Path, environment: dict[str, str]) -> int:
    command = [sys.executable, "setup.py", "--quiet", "build_ext", "--inplace"]
    return subprocess.run(command, cwd=copy, env=environment, check=False).returncode


def _library(name: str) -> str:
    """Where the compiler has a library of its own."""
    compiler = os.environ.get("CXX", "g++")
    found = subprocess.run(
        [compiler, f"-print-file-name={name}"], capture_output=True, text=True, check=True
    )
    return found.stdout.strip()


if __name__ == "__main__":
    raise SystemExit(main())
