"""One NumPy view over the per-joint values that Pinocchio keeps in C++ vectors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.errors import GhcError
from ghc_controller.types import Array


def stacked_view(blocks: Sequence[Array], width: int) -> Array:
    """View (N, width) over N equally spaced blocks of doubles of the same C++ vector.

    Reading a per-joint value through Pinocchio's bindings costs about a microsecond; one view
    over all joints, taken once, lets a compiled kernel read them without any binding call. A
    `std::vector` is contiguous, so that the spacing is constant; this is checked, not assumed.

    Args:
        blocks: view of the first doubles of each of the N elements, in order; they must not own
            their memory and the owner must outlive the result.
        width: doubles to expose per element.

    Raises:
        GhcError: the blocks are copies, or not equally spaced, or closer than `width`.
    """
    if any(block.flags.owndata for block in blocks):
        raise GhcError("joint values are copies: this Pinocchio build exposes no view on them")
    addresses = [block.__array_interface__["data"][0] for block in blocks]
    strides = set(np.diff(addresses).tolist())
    stride = strides.pop() if strides else 8 * width
    if strides or stride < 8 * width:
        raise GhcError("joint values are not equally spaced in memory: unexpected Pinocchio build")
    return np.lib.stride_tricks.as_strided(blocks[0], (len(blocks), width), (stride, 8))
