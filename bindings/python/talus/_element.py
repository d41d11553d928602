"""Laws and element tests."""

from __future__ import annotations

import json
import math
import os
import pathlib
import warnings
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property, lru_cache
from typing import Any, NamedTuple, Optional, Union

import numpy as np
import numpy.typing as npt

from ._case import key_to_toml, to_toml
from ._errors import InputError, RunError
from ._load import solver
from ._results import Table


def laws() -> dict[str, str]:
    """The laws of talus: names and meanings."""
    return dict(solver().names_of_laws())


class Parameter(NamedTuple):
    """A parameter of a law: its value in SI, its unit and its meaning."""

    value: float
    unit: str
    meaning: str


class Quantity(NamedTuple):
    """An output of a law: number of components (1, or 6 for xx yy zz xy yz zx), unit and meaning."""

    components: int
    unit: str
    meaning: str


def _lines(values: Mapping[str, Any]) -> str:
    return "".join(f"{key_to_toml(k)} = {to_toml(v)}\n" for k, v in values.items())


def _contiguous(a: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(a, dtype=float)


def _tensors(name: str, values: Optional[npt.ArrayLike]) -> np.ndarray:
    """Finite numbers of shape (..., 6); zeros for None."""
    tensors = np.zeros(6) if values is None else np.asarray(values, dtype=float)
    if tensors.ndim < 1 or tensors.shape[-1] != 6:
        raise InputError(f"{name} of shape {tensors.shape} must have the shape (..., 6): xx yy zz xy yz zx")
    if not np.isfinite(tensors).all():
        raise InputError(f"{name} has values that are not finite")
    return tensors


def _rows(values: np.ndarray, shape: tuple[int, ...], components: int) -> np.ndarray:
    """A row of components for each point of a shape."""
    try:
        return _contiguous(np.broadcast_to(values, (*shape, components)).reshape(-1, components))
    except ValueError:
        raise InputError(f"an array of shape {values.shape} does not fit points of shape {shape}") from None


def _pressure(name: str, value: Any) -> np.ndarray:
    return np.asarray(solver().to_si(name, value, "Pa") if isinstance(value, str) else value, dtype=float)


class LawState(Mapping):
    """States of points under a law: a mapping from names to arrays, of shape `shape`, with (6,) appended for tensors
    xx yy zz xy yz zx, tension-positive, SI. Arrays are views of `values`: writing to them changes the states."""

    def __init__(self, values: np.ndarray, fields: Sequence[tuple[str, int, str, str]]):
        #: All numbers, shape (*shape, size of a state), in the order of talus_law_state_field of the C interface.
        self.values = values
        self._fields = tuple(fields)
        first = np.cumsum([0] + [components for _, components, _, _ in fields])
        self._places = {f[0]: (int(at), f[1]) for f, at in zip(fields, first)}
        #: Units and meanings by name.
        self.units = {name: unit for name, _, unit, _ in fields}
        self.meanings = {name: meaning for name, _, _, meaning in fields}

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array of points; () for a single point."""
        return self.values.shape[:-1]

    def copy(self) -> "LawState":
        """The same states in an array of their own."""
        return LawState(self.values.copy(), self._fields)

    def __getitem__(self, name: str) -> np.ndarray:
        at, components = self._places[name]
        return self.values[..., at] if components == 1 else self.values[..., at:at + components]

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

    def __repr__(self) -> str:
        return f"<LawState of shape {self.shape}: {', '.join(self)}>"


class LawStep(NamedTuple):
    """Result of a step of points: arrays of the shape of the state. Works belong to a unit of present volume [J/m3]."""

    #: Total stress after the step, shape (..., 6) [Pa], tension-positive.
    stress: np.ndarray
    #: 0 elastic, 1 plastic, 2 zero pressure, 3 separated, 4 not converged.
    outcome: np.ndarray
    #: Energy that unloading gives back [J/m3].
    elastic_energy: np.ndarray
    #: Work of the stress on the strain of this step [J/m3], its plastic and its collisional part.
    work: np.ndarray
    plastic_work: np.ndarray
    collisional_work: np.ndarray
    #: K + 4/3 G [Pa], for the speed of compression waves.
    stiffness: np.ndarray
    #: For the viscous limit of an explicit time step [Pa s].
    viscosity: np.ndarray
    #: Consistent tangent, shape (..., 6, 6) [Pa]: derivative of the stress by the strain increment, whose shear components are
    #: engineering strains. None unless asked for.
    tangent: Optional[np.ndarray] = None


class Law:
    """A constitutive law with its parameters: the keys, units, ranges and refusals of a [material] section.

        sand = talus.Law("granular", E0=150, nu=0.2, phi_c="30 deg", d="1 mm", ...)
        state = sand.initial_state(pressure="100 kPa", void_ratio=0.8)
        step = sand.update(state, [0, -1e-4, 0, 0, 0, 0], dt=0.1, tangent=True)

    Raises InputError with every complaint. `talus list` prints the parameters of all laws.
    """

    def __init__(self, name: str, **keys: Any):
        #: Name of the law.
        self.name = name
        #: The keys as they were given.
        self.keys: dict[str, Any] = dict(keys)
        told = solver().describe_law(f'Law("{name}")', _lines({"law": name, **keys}))
        #: What the law is.
        self.meaning: str = told["meaning"]
        #: Parameters in SI: name -> (value, unit, meaning).
        self.parameters = {key: Parameter(*told_of) for key, told_of in told["parameters"].items()}
        #: Outputs of the law: name -> (components, unit, meaning).
        self.quantities = {key: Quantity(*told_of) for key, told_of in told["quantities"].items()}

        self._name_of_text = f'Law("{name}")'

    # ---- points: signs of the C interface, TENSION IS POSITIVE -----------------------------------------------------

    @cached_property
    def _point(self):
        return solver().PointLaw(self._name_of_text, _lines({"law": self.name, **self.keys}))

    def state(self, values: npt.ArrayLike) -> LawState:
        """States from their numbers, shape (..., size of a state), which are copied."""
        fields = self._point.state_fields()
        numbers = np.array(values, dtype=float, order="C")
        size = sum(components for _, components, _, _ in fields)
        if numbers.ndim < 1 or numbers.shape[-1] != size:
            raise InputError(f"values of shape {numbers.shape}: a state of `{self.name}` has {size} numbers")
        return LawState(numbers, fields)

    def initial_state(self, *, pressure: Any = None, stress: Optional[npt.ArrayLike] = None, void_ratio: npt.ArrayLike = 0.0,
                      kappa: Optional[npt.ArrayLike] = None, background_pressure: Any = 0.0,
                      strain_rate: Optional[npt.ArrayLike] = None,
                      collisional_stress: Optional[npt.ArrayLike] = None) -> LawState:
        """States before the first step.

        `pressure`, compression-positive, or `stress`, shape (..., 6), TENSION-POSITIVE: of enduring contacts [Pa].
        `void_ratio`: of laws that have one. `kappa`: accumulated plastic strain; default: the least that carries the stress.
        `background_pressure` [Pa]: of `mu_i`. `strain_rate` [1/s] and `collisional_stress` [Pa], shape (..., 6): of laws that
        remember them. Pressures are texts with a unit, or numbers in Pa. The values are broadcast against each other; a
        state has their common shape. Raises InputError if a state is impossible."""
        if pressure is not None and stress is not None:
            raise InputError("give `pressure` or `stress`, not both")
        p, background = _pressure("pressure", 0.0 if pressure is None else pressure), _pressure("background_pressure", background_pressure)
        if stress is None:
            if (p < 0).any():
                raise InputError("pressure must be at least 0 Pa; it is compression-positive")
            stress = -p[..., np.newaxis] * np.array([1.0, 1, 1, 0, 0, 0])
        scalars = [np.asarray(v, dtype=float) for v in (void_ratio, np.nan if kappa is None else kappa, background)]
        tensors = [_tensors(name, v) for name, v in (("stress", stress), ("strain_rate", strain_rate), ("collisional_stress", collisional_stress))]
        shape = np.broadcast_shapes(*(v.shape for v in scalars), *(v.shape[:-1] for v in tensors))
        e, k, b = (_contiguous(np.broadcast_to(v, shape).reshape(-1)) for v in scalars)
        s, rate, collisional = (_rows(v, shape, 6) for v in tensors)
        values = self._point.initial(s, e, k, b, rate, collisional)
        return LawState(values.reshape(*shape, values.shape[1]), self._point.state_fields())

    def update(self, state: LawState, strain: npt.ArrayLike, dt: float, strain_rate: Optional[npt.ArrayLike] = None, *,
               tangent: bool = False, integrator: str = "modified_euler", tolerance: float = 1e-6) -> LawStep:
        """Moves states IN PLACE through a step of length `dt` [s]; `state.copy()` before keeps the old ones.

        `strain`: increment, shape (..., 6), tension-positive, xx yy zz xy yz zx, shear strains as tensor components (half the
        engineering strain). `strain_rate`: at the end of the step [1/s]; default: strain/dt, and with dt = 0 an infinitely
        slow step, in which only the rate-independent part of the law acts. The numbers are those of talus_law_update of the
        C interface and of `talus element`, to the bit. Many points are computed at a time; a tangent needs 96 updates."""
        if not (math.isfinite(dt) and dt >= 0):
            raise InputError(f"dt = {dt} must be at least 0 s")
        if not 1e-12 <= tolerance <= 0.1:
            raise InputError(f"tolerance = {tolerance} must be between 1e-12 and 0.1")
        shape = state.shape
        strains = _rows(_tensors("strain", strain), shape, 6)
        rates = None if strain_rate is None else _rows(_tensors("strain_rate", strain_rate), shape, 6).copy()
        states = self._rows_of(state)
        tangents = np.empty((len(states) if tangent else 0, 36))
        told = self._point.update(states, strains, rates, float(dt), integrator, float(tolerance), tangents)
        state.values[...] = states.reshape(state.values.shape)
        outcome, stiffness, viscosity, work, plastic, collisional = (told[:, i].reshape(shape) for i in range(6))
        return LawStep(self._point.stress(states).reshape(*shape, 6), outcome.astype(int),
                       self._point.elastic_energy(states).reshape(shape), work, plastic, collisional, stiffness, viscosity,
                       tangents.reshape(*shape, 6, 6) if tangent else None)

    def stress(self, state: LawState) -> np.ndarray:
        """Total stress of states, shape (..., 6) [Pa], tension-positive."""
        return self._point.stress(self._rows_of(state)).reshape(*state.shape, 6)

    def evaluate(self, state: LawState, strain_rate: Optional[npt.ArrayLike] = None) -> dict[str, np.ndarray]:
        """The `quantities` of the law (pressure, void ratio, inertial number, ...) at states and strain rates (default: rest),
        as `talus element` reports them, but tensors tension-positive."""
        values = self._point.quantities(self._rows_of(state), _rows(_tensors("strain_rate", strain_rate), state.shape, 6))
        told, at = {}, 0
        for name, quantity in self.quantities.items():
            columns = values[:, at:at + quantity.components]
            told[name] = columns.reshape(state.shape if quantity.components == 1 else (*state.shape, 6))
            at += quantity.components
        return told

    def rotate(self, state: LawState, Q: npt.ArrayLike) -> None:
        """Rotates the tensors of states in place, A becomes Q A Q^T; `Q` has shape (..., 3, 3). Rotate states by the
        incremental rotation of the material before the step."""
        rotations = np.asarray(Q, dtype=float)
        if rotations.shape[-2:] != (3, 3) or not np.isfinite(rotations).all():
            raise InputError(f"Q of shape {rotations.shape} must be finite, of shape (..., 3, 3)")
        states = self._rows_of(state)
        self._point.rotate(states, _rows(rotations.reshape(*rotations.shape[:-2], 9), state.shape, 9))
        state.values[...] = states.reshape(state.values.shape)

    def _rows_of(self, state: LawState) -> np.ndarray:
        """The states as rows of an array of their own."""
        if list(state) != [name for name, _, _, _ in self._point.state_fields()]:
            raise InputError(f"the state belongs to another law than `{self.name}`")
        return np.array(state.values.reshape(-1, state.values.shape[-1]), dtype=float, order="C")

    # ---- the law itself --------------------------------------------------------------------------------------------

    def changed(self, **keys: Any) -> "Law":
        """The same law with other values of some keys."""
        return Law(self.name, **{**self.keys, **keys})

    def to_dict(self) -> dict[str, Any]:
        """The section [material.NAME] of a case: case["material"]["sand"] = law.to_dict()."""
        return {"law": self.name, **self.keys}

    def __repr__(self) -> str:
        return f"talus.Law({self.name!r}{''.join(f', {k}={v!r}' for k, v in self.keys.items())})"


class ElementResult(Table):
    """Result of an element test: named columns, compression-positive, a row for the start and each instant of output.
    Columns are arrays of shape (rows,); `units` and `meanings` describe them."""

    #: Number of stress updates, and of those that did not converge.
    n_updates: int
    n_unconverged: int
    #: The input of the test, which `talus element` runs to the same bits.
    text: str


@lru_cache(maxsize=None)
def _keys_of(section: str) -> frozenset[str]:
    """Keys that a section of an element test may have, from the schema of inputs."""
    kinds = json.loads(solver().schema())["anyOf"]
    test = next(kind for kind in kinds if kind["title"] == "an element test")
    return frozenset(test["properties"][section].get("properties", {}))


def element(law: Union[Law, Mapping[str, Any], str, os.PathLike, None] = None, *, initial: Optional[Mapping[str, Any]] = None,
            segments: Optional[Sequence[Mapping[str, Any]]] = None, driver: Optional[Mapping[str, Any]] = None,
            title: str = "element test", **keys: Any) -> ElementResult:
    """Runs an element test: one law along one loading path.

        talus.element(sand, test="triaxial", drainage="drained", pressure="100 kPa", void_ratio=0.8, axial_strain=0.3, rows=150)
        talus.element(sand, initial={...}, segments=[{...}, {...}])
        talus.element("cases/element/drained_triaxial.toml")             # the file of `talus element`, or its text

    `law` is a Law or the keys of a [material] section. Other keys are those of a [[segment]]; keys of [initial] (pressure,
    stress, void_ratio, ...) and [driver] (integrator, tolerance) may stand among them. With `initial`, all keys that
    [initial] and [[segment]] share belong to the segment, such as the target `pressure` of isotropic_compression.
    `segments` is a list of several segments. Stresses and strains are compression-positive; shear strains are tensor
    components. Units and refusals are those of the file.

    Raises InputError with every complaint; RunError if the test fails, with the rows before as its `result`.
    """
    if isinstance(law, (str, os.PathLike)):
        if initial is not None or segments is not None or driver is not None or keys:
            raise TypeError("a file of an element test has its own keys; give a Law to combine it with others")
        is_text = isinstance(law, str) and ("\n" in law or "=" in law)
        try:
            text = str(law) if is_text else pathlib.Path(law).read_text(encoding="utf-8")
        except OSError as e:
            raise InputError(f"cannot open {law}: {e.strerror}") from None
        return _run("element test" if is_text else str(law), text, "" if is_text else str(pathlib.Path(law).parent))
    if law is None:
        raise TypeError("an element test needs a law: talus.element(law, test=...)")
    material = {"law": law.name, **{k: v for k, v in law.keys.items() if k != "density"}} if isinstance(law, Law) else law
    start, how = dict(initial or {}), dict(driver or {})
    for key in list(keys):
        if initial is None and key in _keys_of("initial"):
            start[key] = keys.pop(key)
        elif driver is None and key in _keys_of("driver"):
            how[key] = keys.pop(key)
    if segments is not None and keys:
        raise TypeError(f"with `segments`, {', '.join(keys)} must stand in one of them")
    text = f"title = {to_toml(title)}\n\n[material]\n{_lines(material)}\n[initial]\n{_lines(start)}\n"
    if how:
        text += f"[driver]\n{_lines(how)}\n"
    for segment in segments if segments is not None else [keys]:
        text += f"[[segment]]\n{_lines(segment)}\n"
    return _run("element test", text, "")


def _run(name: str, text: str, folder: str) -> ElementResult:
    told = solver().run_element_test(name, text, folder)
    columns = told["columns"]
    result = ElementResult({column: values for column, (values, _, _) in columns.items()},
                           {column: unit for column, (_, unit, _) in columns.items()},
                           {column: meaning for column, (_, _, meaning) in columns.items()})
    result.n_updates, result.n_unconverged, result.text = told["n_updates"], told["n_unconverged"], text
    if told["failure"]:
        raise RunError(told["failure"], result=result)
    if result.n_unconverged > 0:
        warnings.warn(f"{result.n_unconverged} of {result.n_updates} stress updates did not converge", stacklevel=3)
    return result
