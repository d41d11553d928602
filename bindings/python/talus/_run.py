"""Runs and sweeps by the program `talus`, in separate processes: results are bit-identical to those of the command line, Python
stays responsive, and Ctrl-C stops them with a checkpoint."""

from __future__ import annotations

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

from ._case import Case, as_case, to_toml
from ._errors import Complaint, InputError, RunError
from ._results import Run, Sweep

StrPath = Union[str, os.PathLike]


def _complaints(text: str) -> list[Complaint]:
    """What the program prints about an input, line by line."""
    complaints = []
    for line in text.splitlines():
        found = re.match(r"(?P<file>[^:]+):(?P<line>\d+):(?P<column>\d+): (?P<text>.*)", line)
        if found:
            complaints.append(Complaint(found["file"], int(found["line"]), int(found["column"]), found["text"]))
        elif not re.fullmatch(r"talus: \d+ errors in the input; nothing was run", line):
            complaints.append(Complaint("", 0, 0, line))
    return complaints


def _call(arguments: Sequence[str], progress: bool) -> str:
    """Runs `talus` with these arguments and returns what it printed on stderr. KeyboardInterrupt is passed on to it; it writes
    a checkpoint and ends."""
    environment = dict(os.environ)
    package = str(pathlib.Path(__file__).absolute().parent.parent)
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, [package, environment.get("PYTHONPATH")]))
    environment["TALUS_ENDS_WITH_PARENT"] = "1"
    process = subprocess.Popen([sys.executable, "-m", "talus", *arguments], env=environment, stdin=subprocess.DEVNULL,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace",
                               start_new_session=True)  # Ctrl-C on a terminal is for Python, which passes it on
    lines: list[str] = []
    interrupted = False
    while True:
        try:
            for line in process.stderr:
                lines.append(line)
                if progress:
                    print(line, end="", file=sys.stderr, flush=True)
            code = process.wait()
            break
        except KeyboardInterrupt:  # the second one ends the program at once
            interrupted = True
            process.send_signal(signal.SIGINT)
        except BaseException:
            process.kill()
            process.wait()
            raise
    process.stderr.close()
    text = "".join(lines)
    if interrupted or code in (130, 143):
        raise KeyboardInterrupt(text.strip().splitlines()[-1].strip() if text.strip() else "")
    if code == 2:
        raise InputError(text.strip(), _complaints(text.strip()))
    if code != 0:
        at = text.rfind("\ntalus: ") + 1 if "\ntalus: " in text else 0
        raise RunError(text[at:].strip().removeprefix("talus: ") or f"talus ended with code {code}")
    return text


def _options(**options: Any) -> list[str]:
    words = []
    for name, value in options.items():
        if value is True:
            words.append("--" + name)
        elif value:
            words += ["--" + name, str(value)]
    return words


def run(case: Union[Case, StrPath], out: Optional[StrPath] = None, *, threads: int = 0, until: Optional[str] = None,
        overwrite: bool = False, resume: bool = False, progress: bool = False) -> Run:
    """Runs a case and returns its results, as `talus run` does.

        run = talus.run("cases/slump_2d.toml", out="out/a", progress=True)

    `out` is the folder of the results, by default out/NAME. `until` is a time with unit, such as "0.1 s". `overwrite` replaces
    existing results; `resume` continues from their last checkpoint, with bit-identical results. `progress` shows the messages of
    the program. `threads` is by default the number of processors.

    Raises InputError with all complaints about the case; RunError if the run fails; KeyboardInterrupt after Ctrl-C, when the
    run has written a checkpoint: call again with resume=True to continue.
    """
    case = as_case(case)
    case.check()
    folder = pathlib.Path(out) if out is not None else pathlib.Path("out") / (case.path.stem if case.path else "case")
    options = _options(out=folder, threads=threads, until=until, overwrite=overwrite, resume=resume)
    if case.is_its_file():
        _call(["run", str(case.path), *options], progress)
        return Run(folder)
    # A case without a file of its own is run from its folder, where its text stays as case.toml.
    text, file = case.text_for_other_folder(), folder / "case.toml"
    if file.exists() and file.read_text(encoding="utf-8") != text:
        if not overwrite:
            raise InputError(f"{folder} holds another case, case.toml; give another folder, or overwrite=True")
        if (folder / "history.csv").exists() or any(folder.glob("checkpoint_*.h5")):
            _remove_results(folder)
    folder.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
    _call(["run", str(file), *options], progress)
    return Run(folder)


def _remove_results(folder: pathlib.Path) -> None:
    for name in ("checkpoint_0.h5", "checkpoint_1.h5", "history.csv", "surface.csv", "rings.csv", "record.json",
                 "report.html"):
        (folder / name).unlink(missing_ok=True)


def sweep(case: Union[Case, StrPath], values: Mapping[str, Sequence[Any]], out: Optional[StrPath] = None, *, workers: int = 1,
          threads: int = 0, overwrite: bool = False, progress: bool = False) -> Sweep:
    """Runs a case with every combination of some values, as `talus sweep` does, and returns its results.

        sweep = talus.sweep(case, {"material.glass.phi_c": ["20 deg", "25 deg"]}, out="out/s", workers=2)
        sweep.table()                                    # settings and results, a row a run
        sweep.plot()

    `values` has a list of values for each key. Every run has a folder in `out`, named by its settings; `workers` run at the
    same time, each with `threads` threads, by default the processors divided by the workers. The same call continues a sweep
    that was stopped, and adds runs for new values: complete runs are kept, others resume from their last checkpoint.
    `overwrite` begins every run anew. `progress` shows a line for each run that ends.

    Runs that fail do not stop the others: they are listed in `failures` and in the table, with a warning. Raises InputError
    with the complaints about all runs before the first one starts; KeyboardInterrupt after Ctrl-C, when the runs have written
    checkpoints.
    """
    case = as_case(case)
    folder = pathlib.Path(out) if out is not None else \
        pathlib.Path("out") / f"{case.path.stem if case.path else 'case'}_sweep"
    words = []
    for key, series in values.items():
        if isinstance(series, (str, bytes)):
            raise TypeError(f"{key} needs a list of values")
        words += ["--set", f"{key}={','.join(to_toml(value) for value in series)}"]
    options = [*words, *_options(out=folder, workers=workers, threads=threads, overwrite=overwrite)]
    with tempfile.TemporaryDirectory() as temporary:
        if case.is_its_file():
            file = case.path
        else:
            file = pathlib.Path(temporary) / f"{case.path.stem if case.path else 'case'}.toml"
            file.write_text(case.text_for_other_folder(), encoding="utf-8")
        try:
            _call(["sweep", str(file), *options], progress)
        except InputError as e:
            text = str(e).replace(str(file), case.name)
            raise InputError(text, _complaints(text)) from None
        except RunError as e:
            if not re.search(r"\d+ of \d+ runs failed", str(e)):
                raise
            warnings.warn(str(e), stacklevel=2)
    return Sweep(folder)
