"""Loads the compiled part."""

from __future__ import annotations


def solver():
    """The compiled module `talus._solver`, loaded at its first use: to read results needs none."""
    from . import _solver

    return _solver
