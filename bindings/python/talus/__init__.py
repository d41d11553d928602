"""talus: granular ground that fails, flows and comes to rest.

    import talus
    case = talus.Case("cases/slump_2d.toml")                     # an input file, with keys to get and set
    case["material"]["glass"]["phi_c"] = "30 deg"
    run = talus.run(case, out="out/a", progress=True)            # the program `talus run`, in a process of its own
    run.history, run.snapshots[-1]["velocity"], run.report
    sim = talus.Simulation(case, threads=2)                      # the same run, step by step in this process
    sand = talus.Law("granular", phi_c="30 deg", ...)            # a law, for element tests
    path = talus.element(sand, test="triaxial", ...)
    sweep = talus.sweep(case, {"material.glass.phi_c": ["20 deg", "30 deg"]}, out="out/s", workers=2)
    talus.open("out/a")                                          # results; works without the compiled part

Units are SI; stresses of cases and snapshots are tension-positive, those of element tests compression-positive.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._errors import Complaint, InputError, RunError
from ._plots import plot
from ._results import Run, Snapshot, Snapshots, Sweep, Table, open

if TYPE_CHECKING:
    from ._case import Case, Section, Setting
    from ._element import ElementResult, Law, LawState, LawStep, element, laws
    from ._run import run, sweep
    from ._simulation import Simulation

__all__ = ["Case", "Complaint", "ElementResult", "InputError", "Law", "LawState", "LawStep", "Run", "RunError", "Section", "Setting", "Simulation",
           "Snapshot", "Snapshots", "Sweep", "Table", "element", "laws", "open", "plot", "run", "sweep", "version"]

# What needs the compiled part is imported when it is first used, so that results open without it.
_homes = {"Case": "_case", "Section": "_case", "Setting": "_case", "ElementResult": "_element", "Law": "_element",
          "LawState": "_element", "LawStep": "_element",
          "element": "_element", "laws": "_element", "run": "_run", "sweep": "_run", "Simulation": "_simulation"}


def __getattr__(name: str):
    if name not in _homes:
        raise AttributeError(f"module `talus` has no `{name}`")
    from importlib import import_module

    value = getattr(import_module("." + _homes[name], __name__), name)
    globals()[name] = value
    return value


def __dir__():
    return sorted(set(__all__))


def version() -> str:
    """Version of talus, such as "0.1.0 (a1b2c3d)"."""
    from ._load import solver

    return solver().version()
