"""Charts of several runs, by matplotlib."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Union

from ._results import Run, _module, _read_numbers

#: Colours that remain distinct for the colour-blind (Okabe and Ito 2008).
_colours = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")


def plot(runs: Union[Run, Sequence[Run], Mapping[str, Run]]):
    """Fronts and height over time and the last surface of one or several runs, in common charts. `runs` is a Run, a list of
    runs, or a dict whose keys are the names in the legend. Returns a matplotlib Figure; axes have units."""
    if isinstance(runs, Run):
        runs = [runs]
    named = dict(runs) if isinstance(runs, Mapping) else {run.name: run for run in runs}
    if not isinstance(runs, Mapping) and len(named) < len(runs):
        named = {str(run.folder): run for run in runs}
    if not named:
        raise ValueError("there are no runs to plot")
    figure = _module("matplotlib.figure", "a plot").Figure(figsize=(10, 7), layout="constrained")
    of_fronts, of_height, of_surface, of_energy = figure.subplots(2, 2).flat
    for i, (name, run) in enumerate(named.items()):
        style = {"color": _colours[i % 7], "linestyle": ("-", "--", ":", "-.")[i // 7 % 4]}
        history = _read_numbers(run.folder / "history.csv")
        time = history["time [s]"]
        fronts = ["front_radius [m]"] if "front_radius [m]" in history else ["front_x_min [m]", "front_x_max [m]"]
        for k, front in enumerate(fronts):
            of_fronts.plot(time, history[front], label=name if k == 0 else None, **style)
        of_fronts.set_ylabel("radius of the deposit [m]" if len(fronts) == 1 else "fronts [m]")
        of_height.plot(time, history["height [m]"], **style)
        of_energy.plot(time, history["kinetic_energy [J]"], **style)
        profiles = run.folder / "rings.csv"  # a run in 3D
        if not profiles.exists():
            profiles = run.folder / "surface.csv"
        if profiles.exists():
            columns = _read_numbers(profiles)
            at, place, thickness = columns.values()
            if len(at):
                last = at == at[-1]
                of_surface.plot(place[last], thickness[last], **style)
                of_surface.set_xlabel(list(columns)[1])
    of_height.set_ylabel("height [m]")
    of_energy.set_ylabel("kinetic energy [J]")
    of_surface.set_ylabel("thickness at the last snapshot [m]")
    for axes in (of_fronts, of_height, of_energy):
        axes.set_xlabel("time [s]")
    for axes in figure.axes:
        axes.grid(color="#dddddd")
    if len(named) > 1:
        of_fronts.legend(fontsize="small")
    return figure

