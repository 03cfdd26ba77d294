"""Digest of the sources of a result, found by the imports of its formulation and case.

A change within one formulation leaves the results of the others valid: the formulations that a
method does not import are left out. Of Python and C++ the code counts, without docstrings and
comments; the compiled core and the files of robots, scenes and scenarios count in all cases.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import ghc_controller
import ghc_sim_bridge
from benchmarks.compare.source_text import CORE_SUFFIXES, counted

ROOT = Path(__file__).resolve().parents[2]
_ROOTS = {
    "benchmarks": ROOT / "benchmarks",
    "ghc_controller": Path(ghc_controller.__file__).parent,
    "ghc_sim_bridge": Path(ghc_sim_bridge.__file__).parent,
}
_CHOICE = "ghc_controller.formulations"  # it imports all formulations
_FACES = ("ghc_controller", "ghc_sim_bridge")  # lazy names: what is used is imported below
_ONE_CALL = "ghc_controller.control.compiled_step"  # of `cascade`: other methods do without it
_ALWAYS = ("ghc_controller.controller", "ghc_sim_bridge.simulation.simulator")
_EVERYWHERE = (".yaml", ".urdf", ".xml", *CORE_SUFFIXES)


def digest(modules: Iterable[str], numbers: str = "") -> str:
    """Sixteen hexadecimal digits over these modules, all they import, the core and data files.

    Args:
        numbers: what else a result depends on, as text.
    """
    content = hashlib.sha256(numbers.encode())
    files = {*sources_of(modules), *_common_files()}
    for path in sorted(files, key=lambda path: path.as_posix()):
        content.update(path.name.encode())
        content.update(counted(path))
    return content.hexdigest()[:16]


def sources_of(modules: Iterable[str]) -> set[Path]:
    """Files of these modules and, in turn, of what they import of this repository."""
    waiting, seen, found = [*modules, *_ALWAYS], set(), set()
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        path = _file_of(name)
        if path is None or name == _CHOICE or name in _FACES:
            continue
        found.add(path)
        waiting += [each for each in _imports(path) if not _leaves_out(name, each)]
        waiting += [name.rpartition(".")[0]] if "." in name else []
    return found


def _leaves_out(name: str, imported: str) -> bool:
    """Whether an import counts only for methods that have it by their formulation."""
    return name == _ONE_CALL and imported.startswith(f"{_CHOICE}.")


@cache
def _imports(path: Path) -> tuple[str, ...]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return tuple(_names(tree))


def _names(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@cache
def _file_of(module: str) -> Path | None:
    """File of a module of this repository; None for another one, or for a name in a module."""
    first, *rest = module.split(".")
    if first not in _ROOTS:
        return None
    base = _ROOTS[first].joinpath(*rest)
    for path in (base / "__init__.py", base.with_suffix(".py")):
        if path.is_file():
            return path
    return None


@cache
def _common_files() -> tuple[Path, ...]:
    packages = [_ROOTS[name] for name in _FACES]
    return tuple(
        path for root in packages for path in sorted(root.rglob("*")) if path.suffix in _EVERYWHERE
    )
