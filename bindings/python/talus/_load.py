"""Loads the compiled part."""

from __future__ import annotations


def solver():
    """The compiled module `talus._solver`, which what only reads results does without."""
    from . import _solver

    return _solver
