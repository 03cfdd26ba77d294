"""Compiles the generators' kernels into the cache beside their sources: `python -m` with this.

A generator compiles what it needs when it is made. With the cache filled that takes a fraction of
a second, without it some ten seconds.
"""

from __future__ import annotations

from ghc_mpc_constraints.generator import GENERATORS


def main() -> None:
    """Make one generator of each kind of this package."""
    for name in GENERATORS.built_in:
        kind = GENERATORS[name]
        kind(kind.settings_type())


if __name__ == "__main__":
    main()
