"""Results of runs and sweeps, read from their folders. Needs numpy; h5py for snapshots; pandas, xarray and pyvista where they
are asked for. The compiled part of talus is not needed."""

from __future__ import annotations

import builtins
import csv
import html
import json
import os
import pathlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Optional, Union

import numpy as np

from ._errors import InputError

StrPath = Union[str, os.PathLike]


def _module(name: str, purpose: str):
    """An optional package, or a sentence what it is needed for."""
    from importlib import import_module

    try:
        return import_module(name)
    except ImportError as e:
        package = "python3-" + name.split(".")[0]
        raise ImportError(f"{purpose} needs the package {name.split('.')[0]} (Debian: {package})") from e


def _has(name: str) -> bool:
    from importlib.util import find_spec

    return find_spec(name) is not None


class Table(Mapping):
    """Named columns of equal length: a mapping from names to arrays of shape (rows,). `units` and `meanings` have the same
    keys."""

    def __init__(self, columns: Mapping[str, np.ndarray], units: Mapping[str, str] = {}, meanings: Mapping[str, str] = {}):
        self._columns = dict(columns)
        #: Unit of each column, "1" for numbers without one.
        self.units = {name: units.get(name, "1") for name in self._columns}
        #: Meaning of each column, where it is known.
        self.meanings = dict(meanings)

    def __getitem__(self, name: str) -> np.ndarray:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def n_rows(self) -> int:
        return len(next(iter(self._columns.values()), ()))

    def to_pandas(self):
        """The table as pandas.DataFrame."""
        return _module("pandas", "to_pandas").DataFrame(self._columns)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.n_rows} rows of {', '.join(self._columns)}>"


def _read_numbers(file: pathlib.Path) -> dict[str, np.ndarray]:
    """Columns of a CSV file of numbers, by their names with units."""
    with builtins.open(file, encoding="utf-8") as f:
        names = f.readline().rstrip("\n").split(",")
        rows = np.array([[float(x or "nan") for x in line.split(",")] for line in f if line.count(",") == len(names) - 1])
    rows = rows.reshape(-1, len(names))
    return {name: np.ascontiguousarray(rows[:, i]) for i, name in enumerate(names)}


def _name_and_unit(column: str) -> tuple[str, str]:
    name, _, unit = column.partition(" [")
    return name, unit.rstrip("]") or "1"


def _as_table(columns: dict[str, np.ndarray]):
    """pandas.DataFrame where pandas is installed, else a Table; both with the same column names."""
    if _has("pandas"):
        import pandas

        return pandas.DataFrame(columns)
    return Table(columns, {name: _name_and_unit(name)[1] for name in columns})


class Snapshot(Mapping):
    """Particles of a run at one instant: a mapping from names of quantities to arrays, read from the file when they are asked
    for. `snapshot["position"]` has shape (particles, 3) [m]; scalars (particles,), vectors (particles, 3), tensors
    (particles, 6): xx yy zz xy yz zx, tension-positive. Quantities have single precision, positions double."""

    def __init__(self, file: pathlib.Path):
        #: The HDF5 file.
        self.file = file
        with self._opened() as f:
            #: Time [s].
            self.time = float(f["talus/time"][0])
            #: Number of steps before.
            self.step = int(f["talus/step"][0])
            self._names = ["position", *f["VTKHDF/PointData"]]

    def _opened(self):
        return _module("h5py", "a snapshot").File(self.file, "r")

    def _dataset(self, f, name: str):
        if name not in self._names:
            raise KeyError(f"{name}; {self.file.name} has {', '.join(self._names)} (`fields` in [output])")
        return f["VTKHDF/Points"] if name == "position" else f["VTKHDF/PointData"][name]

    def __getitem__(self, name: str) -> np.ndarray:
        with self._opened() as f:
            return self._dataset(f, name)[()]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def _attribute(self, name: str, attribute: str) -> str:
        with self._opened() as f:
            told = self._dataset(f, name).attrs.get(attribute, b"")
        return (told.decode() if isinstance(told, bytes) else str(told)).strip()

    def unit(self, name: str) -> str:
        """Unit of a quantity."""
        return self._attribute(name, "units")

    def meaning(self, name: str) -> str:
        """Meaning of a quantity."""
        return self._attribute(name, "meaning")

    @property
    def units(self) -> dict[str, str]:
        """Units of all quantities."""
        return {name: self.unit(name) for name in self}

    def to_dict(self) -> dict[str, np.ndarray]:
        """All quantities."""
        return {name: self[name] for name in self}

    def to_pandas(self):
        """A row a particle; components of vectors and tensors are columns such as velocity_x and stress_xx."""
        suffixes = {3: ("x", "y", "z"), 6: ("xx", "yy", "zz", "xy", "yz", "zx")}
        columns = {}
        for name, values in self.to_dict().items():
            if values.ndim == 1:
                columns[name] = values
            else:
                for i, suffix in enumerate(suffixes[values.shape[1]]):
                    columns[f"{name}_{suffix}"] = values[:, i]
        return _module("pandas", "to_pandas").DataFrame(columns)

    def to_pyvista(self):
        """A pyvista.PolyData of the particles with all quantities."""
        pyvista = _module("pyvista", "to_pyvista")
        values = self.to_dict()
        cloud = pyvista.PolyData(values.pop("position"))
        for name, array in values.items():
            cloud.point_data[name] = array
        return cloud

    def __repr__(self) -> str:
        return f"<talus.Snapshot {self.file.name}, t = {self.time:.6g} s: {', '.join(self._names)}>"


class Snapshots(Sequence):
    """Snapshots of a run in the order of time; `snapshots[-1]` is the last one."""

    def __init__(self, folder: pathlib.Path):
        series = folder / "particles.hdf.series"
        listed = json.loads(series.read_text())["files"] if series.exists() else []
        #: Times of the snapshots [s].
        self.times = np.array([entry["time"] for entry in listed])
        self._files = [folder / entry["name"] for entry in listed]

    def __getitem__(self, i):
        if isinstance(i, slice):
            return [Snapshot(file) for file in self._files[i]]
        return Snapshot(self._files[i])

    def __len__(self) -> int:
        return len(self._files)

    def at(self, time: float) -> Snapshot:
        """The snapshot nearest to a time [s]."""
        return self[int(np.argmin(np.abs(self.times - time)))]


def _read_asc(file: pathlib.Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """An ESRI ASCII raster: eastings and northings of the middles of its pixels, and values, NaN where there are none."""
    header: dict[str, float] = {}
    with builtins.open(file, encoding="ascii") as f:
        position = f.tell()
        for line in iter(f.readline, ""):
            words = line.split()
            if len(words) != 2 or words[0][0] not in "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ":
                f.seek(position)
                break
            header[words[0].lower()] = float(words[1])
            position = f.tell()
        values = np.array(f.read().split(), dtype=float)
    values = values.reshape(int(header["nrows"]), int(header["ncols"]))
    values[values == header.get("nodata_value", -9999)] = np.nan
    size = header["cellsize"]
    x0 = header["xllcorner"] + size / 2 if "xllcorner" in header else header["xllcenter"]
    y0 = header["yllcorner"] + size / 2 if "yllcorner" in header else header["yllcenter"]
    return x0 + size * np.arange(values.shape[1]), y0 + size * np.arange(values.shape[0])[::-1], values


def _read_tif(file: pathlib.Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    gdal = _module("osgeo.gdal", "a raster in GeoTIFF")
    raster = gdal.Open(str(file))
    x0, dx, _, y0, _, dy = raster.GetGeoTransform()
    band = raster.GetRasterBand(1)
    values = band.ReadAsArray().astype(float)
    if band.GetNoDataValue() is not None:
        values[values == band.GetNoDataValue()] = np.nan
    return x0 + dx * (np.arange(values.shape[1]) + 0.5), y0 + dy * (np.arange(values.shape[0]) + 0.5), values


class Rasters(Mapping):
    """Maps of a run on terrain, by the names of their files without ending: xarray.DataArray with the coordinates `north` and
    `east` [m] where xarray is installed, else (east, north, values) with values of shape (north, east). NaN where there is no
    flow."""

    def __init__(self, folder: pathlib.Path):
        self._files = {file.stem: file for file in sorted((folder / "maps").glob("*")) if file.suffix in (".asc", ".tif")}

    def __getitem__(self, name: str):
        file = self._files[name]
        east, north, values = _read_asc(file) if file.suffix == ".asc" else _read_tif(file)
        if not _has("xarray"):
            return east, north, values
        import xarray

        return xarray.DataArray(values, dims=("north", "east"), name=name,
                                coords={"north": ("north", north, {"units": "m"}), "east": ("east", east, {"units": "m"})})

    def __iter__(self) -> Iterator[str]:
        return iter(self._files)

    def __len__(self) -> int:
        return len(self._files)


def _surface(file: pathlib.Path, quantity: str):
    """A quantity of surface.csv or rings.csv, such as "thickness", by time and place."""
    columns = _read_numbers(file)
    units = dict(map(_name_and_unit, columns))
    if quantity not in units:
        raise ValueError(f"{file} has no {quantity}; only runs in 3D have")
    if not _has("xarray"):
        return _as_table(columns)
    import xarray

    numbers = dict(zip(units, columns.values()))
    dims = [name for name in ("time", "y", "x", "radius") if name in units]
    places, rows = zip(*(np.unique(numbers[name], return_inverse=True) for name in dims))
    values = np.full([len(p) for p in places], np.nan)
    values[rows] = numbers[quantity]
    return xarray.DataArray(values, dims=dims, name=quantity, attrs={"units": units[quantity]},
                            coords={n: (n, p, {"units": units[n]}) for n, p in zip(dims, places)})


class Run:
    """The results of a run in its folder, as `talus run` writes them. Files are read when they are asked for, so a run that
    goes on can be looked at."""

    def __init__(self, folder: StrPath):
        #: The folder.
        self.folder = pathlib.Path(folder)
        if not (self.folder / "history.csv").exists():
            raise InputError(f"{self.folder} holds no results of a run: there is no history.csv")

    @property
    def name(self) -> str:
        """Name of the folder."""
        return self.folder.resolve().name

    @property
    def record(self) -> dict[str, Any]:
        """record.json: version, case, machine, outcome, warnings, energy balance, forces. Empty until the run has ended."""
        file = self.folder / "record.json"
        return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}

    @property
    def outcome(self) -> str:
        """"finished", "failed", "stopped" by a signal, or "running" without a record."""
        return self.record.get("run", {}).get("outcome", "running")

    @property
    def failure(self) -> str:
        """Reason why the run failed; empty if it did not."""
        return self.record.get("run", {}).get("failure", "")

    @property
    def warnings(self) -> list[str]:
        """Warnings of the run."""
        return self.record.get("run", {}).get("warnings", [])

    @property
    def settings(self) -> dict[str, dict[str, Any]]:
        """All settings by their paths: {"material.glass.d": {"value": "1 mm", "default": False, "meaning": ...}}."""
        return self.record.get("case", {})

    @property
    def case_text(self) -> str:
        """The input file of the run."""
        return (self.folder / "case.toml").read_text(encoding="utf-8")

    def table(self, name: str):
        """A CSV file of the folder, such as "gauges.csv": pandas.DataFrame where pandas is installed, else a Table. Column
        names have their units: "height [m]"."""
        file = self.folder / name
        if not file.exists():
            raise FileNotFoundError(f"{self.folder} has no {name}")
        return _as_table(_read_numbers(file))

    @property
    def history(self):
        """history.csv: a row an instant. Columns are named with units, "time [s]", "front_x_max [m]". pandas.DataFrame where
        pandas is installed, else a Table."""
        return self.table("history.csv")

    @property
    def surface(self):
        """Thickness of the material above the ground at the times of the snapshots [m]: xarray.DataArray with the
        coordinates `time` [s] and `x` or `radius` [m], in 3D `time`, `y` and `x`, where xarray is installed, NaN where there is
        no material; else the table surface.csv."""
        return _surface(self.folder / "surface.csv", "thickness")

    @property
    def surface_speed(self):
        """Mean speed of the material on each patch of ground, weighted with mass, of a run in 3D [m/s]; as `surface`."""
        return _surface(self.folder / "surface.csv", "speed")

    @property
    def rings(self):
        """Thickness of the material in rings about the axis, of a run in 3D [m]; as `surface`, with the coordinates `time` and
        `radius`. Without xarray the table rings.csv."""
        return _surface(self.folder / "rings.csv", "thickness")

    @property
    def snapshots(self) -> Snapshots:
        """All particles at some instants."""
        return Snapshots(self.folder)

    @property
    def rasters(self) -> Rasters:
        """Maps of a run on terrain."""
        return Rasters(self.folder)

    @property
    def gauges(self):
        """gauges.csv of a run on terrain with gauges, as `history`."""
        return self.table("gauges.csv")

    @property
    def pictures(self) -> dict[str, pathlib.Path]:
        """Pictures and curves by name."""
        return {file.stem: file for file in sorted((self.folder / "pictures").glob("*")) if file.suffix in (".png", ".svg")}

    @property
    def report(self) -> pathlib.Path:
        """report.html, the whole run in one page."""
        return self.folder / "report.html"

    def plot(self):
        """Fronts, height and surface: a matplotlib Figure."""
        from ._plots import plot

        return plot([self])

    def __repr__(self) -> str:
        return f"<talus.Run {str(self.folder)!r}: {self.outcome}>"


class Sweep:
    """The runs of a sweep in its folder, as `talus sweep` and `talus.sweep` write it."""

    def __init__(self, folder: StrPath):
        #: The folder.
        self.folder = pathlib.Path(folder)
        file = self.folder / "sweep.json"
        if not file.exists():
            raise InputError(f"{self.folder} holds no sweep: there is no sweep.json")
        self._file = file

    @property
    def record(self) -> dict[str, Any]:
        """sweep.json: the case, the keys and values, and for every run name, settings, hash of its case, outcome, failure."""
        return json.loads(self._file.read_text(encoding="utf-8"))

    @property
    def settings(self) -> dict[str, dict[str, str]]:
        """Settings of each run by its name."""
        return {run["name"]: run["settings"] for run in self.record["runs"]}

    @property
    def runs(self) -> dict[str, Run]:
        """Runs that have results, by their names."""
        return {run["name"]: Run(self.folder / run["name"]) for run in self.record["runs"]
                if (self.folder / run["name"] / "history.csv").exists()}

    def __getitem__(self, name: str) -> Run:
        return self.runs[name]

    def __len__(self) -> int:
        return len(self.record["runs"])

    @property
    def failures(self) -> dict[str, str]:
        """Runs that failed, and why."""
        return {run["name"]: run["failure"] for run in self.record["runs"] if run["outcome"] == "failed"}

    def table(self):
        """A row a run: its name, settings, outcome, the last row of its history, failure and hash. A setting is a number with
        its unit in the name of the column if all its values have the same unit. pandas.DataFrame; a Table without pandas."""
        with builtins.open(self.folder / "table.csv", encoding="utf-8", newline="") as f:
            header, *rows = list(csv.reader(f))
        columns: dict[str, Any] = {}
        texts = ("run", "outcome", "failure", "hash")
        for i, name in enumerate(header):
            values = [row[i] for row in rows]
            try:
                if name in texts:
                    raise ValueError
                columns[name] = np.array([float(v or "nan") for v in values])
            except ValueError:
                columns[name] = np.array(values, dtype=object)
        return _as_table(columns)

    def plot(self):
        """Fronts, heights and last surfaces of all runs in common charts: a matplotlib Figure."""
        from ._plots import plot

        return plot(list(self.runs.values()))

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><td>{html.escape(run['name'])}</td><td>{run['outcome']}</td><td>{html.escape(run['failure'])}</td></tr>"
                       for run in self.record["runs"])
        return f"<table><tr><th>run</th><th>outcome</th><th>failure</th></tr>{rows}</table>"

    def __repr__(self) -> str:
        outcomes = [run["outcome"] for run in self.record["runs"]]
        told = ", ".join(f"{outcomes.count(o)} {o}" for o in dict.fromkeys(outcomes))
        return f"<talus.Sweep {str(self.folder)!r}: {len(outcomes)} runs, {told}>"


def open(folder: StrPath) -> Union[Run, Sweep]:
    """Opens the folder of a run or a sweep. The solver is not needed.

        run = talus.open("out/slump_2d")
        run.history["height [m]"], run.snapshots[-1]["velocity"]
    """
    folder = pathlib.Path(folder)
    if (folder / "sweep.json").exists():
        return Sweep(folder)
    if not folder.is_dir():
        raise InputError(f"{folder}: there is no such folder")
    return Run(folder)
