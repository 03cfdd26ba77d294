"""Constraints that jump become bounds that move: previews over a receding horizon."""

from ghc_controller.migration.finder import install

install()  # of modules that have moved
