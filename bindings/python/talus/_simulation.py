"""A run step by step, in this process."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Optional, Union

from ._case import Case, as_case
from ._load import solver

if TYPE_CHECKING:
    from ._solver import Particles


class Simulation:
    """A run of the material point method, step by step.

        sim = talus.Simulation("cases/slump_2d.toml", threads=2)
        while sim.time < 0.2:
            sim.step(until=sim.time + 0.01)
            x = sim.particles["position"]                 # (particles, 3) [m]

    The steps have the bits of `talus run`, at any number of threads. Nothing is written; `talus.run` writes results.
    `threads` is the number of threads; by default that of the processors. Raises InputError with all complaints about the
    case.
    """

    def __init__(self, case: Union[Case, str, os.PathLike], threads: int = 0):
        case = as_case(case)
        if not 0 <= threads <= 4096:
            raise ValueError("threads must be between 1 and 4096, or 0 for all processors")
        self._simulation = solver().Simulation(case.name, case.text, str(case.folder), threads)

    def step(self, until: Optional[float] = None) -> None:
        """Makes one step; with `until` [s], steps until the time is at least that. Steps are not shortened to meet a time:
        the simulation stops at the first step at or after it, like the snapshots of a run. Other threads of Python run
        meanwhile. Ctrl-C raises KeyboardInterrupt between two steps, and the simulation can go on after it. Raises RunError
        if the run fails; it cannot go on after that."""
        self._simulation.step(until)

    @property
    def particles(self) -> "Particles":
        """Particles at the present instant: a mapping from the names of quantities to read-only arrays, in the order of the
        particles' ids. Shape (particles,) for scalars, (particles, 3) for vectors, (particles, 6) for tensors xx yy zz xy yz
        zx, tension-positive. `particles.unit(name)` and `particles.meaning(name)` describe a quantity.

        The solver gathers the particles once per instant, at the first access; every access of an array is then a view of
        these numbers, without a copy. The numbers belong to the instant: arrays keep their values when the simulation steps
        on, and stay valid as long as somebody holds them, also after the simulation is gone. Ask `particles` again after a
        step for the new values. Rows change where particles split, merge or leave; the quantity `id` identifies them."""
        return self._simulation.particles

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._simulation.time

    @property
    def n_steps(self) -> int:
        """Number of steps so far."""
        return self._simulation.n_steps

    @property
    def dt(self) -> float:
        """Length of the last step [s]."""
        return self._simulation.dt

    @property
    def n_particles(self) -> int:
        """Number of particles."""
        return self._simulation.n_particles

    @property
    def end(self) -> float:
        """End of the run as the case has it [s]; `step` goes on beyond it."""
        return self._simulation.end

    @property
    def threads(self) -> int:
        """Number of threads."""
        return self._simulation.threads

    @property
    def title(self) -> str:
        """Title of the case."""
        return self._simulation.title

    @property
    def energies(self) -> dict[str, float]:
        """Energy balance [J], as in history.csv: kinetic, potential, elastic, plastic, collisional, averaging, viscous,
        numerical, wall_friction, work_on_solids, error, turnover. In plane strain per metre of thickness, axisymmetric per
        radian."""
        return self._simulation.energies

    @property
    def outline(self) -> dict[str, float]:
        """Fronts and heights of the material [m], as in history.csv: front_x_min, front_x_max, height, height_at_axis; in 3D
        also front_y_min, front_y_max; in 3D and axisymmetric front_radius."""
        return self._simulation.outline

    def __repr__(self) -> str:
        return f"<talus.Simulation {self.title!r}: {self.n_particles} particles, t = {self.time:.6g} s>"
