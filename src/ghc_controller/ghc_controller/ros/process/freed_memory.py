"""Memory that the C library keeps after it was freed.

glibc gives every thread that allocates while others do an arena of its own, up to eight per CPU,
and keeps what was freed in each: resident memory of a process that frees all it takes still grows
for hours. Without glibc both functions do nothing.
"""

from __future__ import annotations

import ctypes

_M_ARENA_MAX = -8  # of mallopt, from malloc.h
ARENAS = 2  # one for Python and callbacks, one for the threads of the middleware
_LIBRARY = ctypes.CDLL(None)


def limit_arenas(count: int = ARENAS) -> bool:
    """Let threads share `count` arenas; call before there are any. Whether it took effect."""
    mallopt = getattr(_LIBRARY, "mallopt", None)
    return mallopt is not None and bool(mallopt(_M_ARENA_MAX, count))


def return_freed_memory() -> bool:
    """Give free pages back to the system: 0.1 to some ms. Whether there were any."""
    trim = getattr(_LIBRARY, "malloc_trim", None)
    return trim is not None and bool(trim(ctypes.c_size_t(0)))
