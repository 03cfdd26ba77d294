"""What counts of a source file for a digest: its code, without words about it."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from functools import cache
from pathlib import Path

CORE_SUFFIXES = (".cpp", ".hpp")  # of the compiled core
_DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
# A string, a character, or a comment of C++; only comments leave the text.
_CPP = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|//[^\n]*|/\*.*?\*/', re.DOTALL)


def counted(path: Path) -> bytes:
    """Content of a file; of Python and C++ without docstrings, comments and blank lines."""
    if path.suffix == ".py":
        return _python_code(path.read_text(encoding="utf-8"))
    if path.suffix in CORE_SUFFIXES:
        return _cpp_code(path.read_text(encoding="utf-8"))
    return path.read_bytes()


@cache
def _python_code(source: str) -> bytes:
    lines = source.splitlines()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, _DOCUMENTED) and ast.get_docstring(node, clean=False) is not None:
            text = node.body[0]
            for line in range(text.lineno - 1, text.end_lineno or text.lineno):
                lines[line] = ""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            line, column = token.start
            lines[line - 1] = lines[line - 1][:column]
    return _without_blank_lines(lines)


@cache
def _cpp_code(source: str) -> bytes:
    def kept(match: re.Match[str]) -> str:
        return " " if match[0].startswith("/") else match[0]

    return _without_blank_lines(_CPP.sub(kept, source).splitlines())


def _without_blank_lines(lines: list[str]) -> bytes:
    return "\n".join(line.rstrip() for line in lines if line.strip()).encode()
