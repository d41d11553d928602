"""Laws and element tests."""

from __future__ import annotations

import json
import os
import pathlib
import warnings
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple, Optional, Union

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


class Law:
    """A constitutive law with its parameters: the keys, units, ranges and refusals of a [material] section.

        sand = talus.Law("granular", E0=150, nu=0.2, phi_c="30 deg", d="1 mm", ...)

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
