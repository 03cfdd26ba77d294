"""Hierarchy strings such as "end_effector > elbow = gaze > posture"."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.hierarchy.priority_matrix import PriorityMatrix, complete_removals

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_FORM = "expected task names joined by '>' (strict) or '=' (equal), as in 'a > b = c'"


def parse_levels(hierarchy: str) -> list[list[str]]:
    """Levels of a hierarchy string, highest first.

    Raises:
        InvalidValue: the string is empty, malformed, or names a task twice.
    """
    levels = [[name.strip() for name in level.split("=")] for level in hierarchy.split(">")]
    names = [name for level in levels for name in level]
    for name in names:
        if not _NAME.match(name):
            raise InvalidValue(f"malformed hierarchy '{hierarchy}': found '{name}', {_FORM}")
    twice = sorted(name for name, count in Counter(names).items() if count > 1)
    if twice:
        raise InvalidValue(f"hierarchy '{hierarchy}' names {', '.join(twice)} more than once")
    return levels


def matrix_from_hierarchy(known_tasks: Sequence[str], hierarchy: str) -> PriorityMatrix:
    """Priority matrix of a hierarchy string; a task that is left out is removed.

    `a > b`: alpha[b, a] = 1, alpha[a, b] = 0 (transitive). `a = b`: 0.5 both ways, the equal
    compromise with alpha_ij + alpha_ji = 1 (GHC paper, section 6.3).

    Raises:
        InvalidValue: malformed string. UnknownName: a task that does not exist.
    """
    levels = parse_levels(hierarchy)
    order = list(known_tasks)
    level_of: dict[str, int] = {}
    for depth, level in enumerate(levels):
        for name in level:
            if name not in order:
                raise UnknownName("task", name, known_tasks)
            level_of[name] = depth
    alpha = np.ones((len(order), len(order)))
    for i, lower in enumerate(order):
        for j, upper in enumerate(order):
            if lower in level_of and upper in level_of:
                alpha[i, j] = _entry(level_of[lower], level_of[upper], i == j)
    return PriorityMatrix(tuple(order), complete_removals(alpha))


def _entry(level: int, other: int, same_task: bool) -> float:
    if same_task:
        return 0.0
    if level == other:
        return 0.5
    return 1.0 if other < level else 0.0


def format_hierarchy(matrix: PriorityMatrix) -> str:
    """Hierarchy string of a matrix, or "" when no string gives exactly this matrix."""
    active = [i for i in range(len(matrix.tasks)) if matrix.alpha[i, i] < 1.0]
    if not active:
        return ""
    above = {i: sum(matrix.alpha[i, j] for j in active if j != i) for i in active}
    levels: dict[float, list[str]] = {}
    for i in active:
        levels.setdefault(above[i], []).append(matrix.tasks[i])
    text = " > ".join(" = ".join(levels[key]) for key in sorted(levels))
    same = matrix_from_hierarchy(matrix.tasks, text).alpha
    return text if np.array_equal(same, matrix.alpha) else ""
