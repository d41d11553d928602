"""Loads the compiled part."""

from __future__ import annotations

import os


def solver():
    """The compiled module `talus._solver`. OpenMP reads its environment when it is loaded: threads that wait for each other
    a few microseconds spin that long and then sleep, as in the program `talus`."""
    if "OMP_WAIT_POLICY" not in os.environ:
        os.environ.setdefault("GOMP_SPINCOUNT", "1000")
    from . import _solver

    return _solver
