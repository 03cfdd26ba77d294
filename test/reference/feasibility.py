"""Whether any point meets all rows of a plain problem: a linear program solved by HiGHS."""

from __future__ import annotations

import numpy as np
from reference.plain import Plain
from scipy.optimize import linprog


def margin(problem: Plain, cap: float = 1.0) -> float:
    """Largest distance [rad/s^2, Nm, N] that some (x, f) keeps to all bounds, at most `cap`.

    Negative where no point meets them all; -inf where HiGHS finds none at all, for example
    because contacts and balance contradict each other.
    """
    n, u, contacts = len(problem.bias), problem.unactuated, problem.contacts
    reach = problem.force_jacobian.T
    c = reach.shape[1]
    full = np.hstack([problem.mass, -reach])
    motion = np.hstack([np.eye(n), np.zeros((n, c))])
    blocks = [
        (motion, problem.lower, problem.upper),
        (
            full[u:],
            problem.torque_lower - problem.bias[u:],
            problem.torque_upper - problem.bias[u:],
        ),
    ]
    equal, right = [full[:u]], [-problem.bias[:u]]
    if problem.rows is not None:
        matrix, lower, upper = problem.rows
        blocks.append((matrix @ motion, lower, upper))
    if contacts is not None:
        matrix, lower, upper = contacts.forces
        blocks.append((np.hstack([np.zeros((len(lower), n)), matrix]), lower, upper))
        equal.append(np.hstack([contacts.jacobian, np.zeros((len(contacts.drift), c))]))
        right.append(contacts.drift)
    G = np.vstack([part for A, _, _ in blocks for part in (A, -A)])
    h = np.concatenate([part for _, low, high in blocks for part in (high, -low)])
    finite = np.isfinite(h)
    E, e = np.vstack(equal), np.concatenate(right)
    found = linprog(
        np.append(np.zeros(n + c), -1.0),
        np.hstack([G, np.ones((len(h), 1))])[finite],
        h[finite],
        np.hstack([E, np.zeros((len(e), 1))]) if len(e) else None,
        e if len(e) else None,
        bounds=[(None, None)] * (n + c) + [(None, cap)],
        method="highs",
    )
    return -float(found.fun) if found.status == 0 else -np.inf
