"""The compiled core: the per-tick path of the default formulation, in C++ with Eigen."""

from ghc_controller.core.native import Cascade, NullSpace, level_damping, level_optimum

__all__ = ["Cascade", "NullSpace", "level_damping", "level_optimum"]
