"""Cases: input files whose keys can be read and set."""

from __future__ import annotations

import difflib
import json
import os
import pathlib
import tomllib
from collections.abc import Iterator, Mapping, MutableMapping, Sequence
from typing import Any, NamedTuple, Optional, Union

from ._errors import InputError
from ._load import solver


def to_toml(value: Any) -> str:
    """A value as TOML: texts in quotes, lists, tables; numbers and arrays of numpy as well."""
    if hasattr(value, "tolist"):  # numpy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key_to_toml(k)} = {to_toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, Sequence):
        return "[" + ", ".join(to_toml(v) for v in value) + "]"
    raise TypeError(f"{value!r} is no value of a case; give a text with a unit, a number, a bool, a list or a dict")


def key_to_toml(key: str) -> str:
    return key if key and all(c.isascii() and (c.isalnum() or c in "_-") for c in key) else json.dumps(key)


class Setting(NamedTuple):
    """A setting as talus reads it: the value in words, and whether it is the default."""

    value: str
    default: bool
    meaning: str


class Section(MutableMapping):
    """A table of a case. Values are those of the file: texts with units, numbers, bools, tuples; tables are Sections.
    Setting a value changes the text of the case and nothing else: comments and the order of tables stay."""

    def __init__(self, case: "Case", path: tuple[str, ...]):
        self._case = case
        self._path = path

    def _values(self) -> dict:
        values = self._case._parsed()
        for part in self._path:
            try:
                values = values[int(part[1:-1])] if part.startswith("[") else values[part]
            except (KeyError, IndexError):
                raise KeyError(".".join(self._path)) from None
        return values

    def _wrap(self, value: Any, path: tuple[str, ...]) -> Any:
        if isinstance(value, dict):
            return Section(self._case, path)
        if isinstance(value, list):  # a change of a list in place would be lost
            return tuple(self._wrap(v, (*path, f"[{i}]")) for i, v in enumerate(value))
        return value

    def _split(self, key: str) -> tuple["Section", str]:
        """Where a key with dots leads: "glass.phi_c" is phi_c of the section `glass`."""
        if not isinstance(key, str):
            raise TypeError("keys are texts")
        if "." not in key or key in self._values():
            return self, key
        parts = key.split(".")
        return Section(self._case, (*self._path, *parts[:-1])), parts[-1]

    def __getitem__(self, key: str) -> Any:
        section, last = self._split(key)
        values = section._values()
        if last not in values:
            alike = difflib.get_close_matches(str(last), list(values), 1)
            raise KeyError(".".join((*section._path, last)) + (f"; did you mean `{alike[0]}`?" if alike else ""))
        return self._wrap(values[last], (*section._path, last))

    def __setitem__(self, key: str, value: Any) -> None:
        section, last = self._split(key)
        path = (*section._path, last)
        try:
            old = section._values().get(last)
        except KeyError:
            old = None
        if isinstance(value, Section):
            value = value.to_dict()
        case = self._case
        if isinstance(value, Mapping) and old is None:
            header = ".".join(key_to_toml(part) for part in path)
            lines = "".join(f"{key_to_toml(k)} = {to_toml(v)}\n" for k, v in value.items())
            case._change(case.text.rstrip("\n") + f"\n\n[{header}]\n{lines}")
        elif isinstance(value, Mapping) and case._is_table_of_lines(path):
            section._replace_table(last, value)
        else:
            case._change(solver().with_value(case.name, case.text, list(path), to_toml(value)))

    def _replace_table(self, key: str, value: Mapping) -> None:
        """Gives a table other keys and values. What stays equal keeps its lines; nothing changes if a key cannot be removed."""
        table, before = Section(self._case, (*self._path, key)), self._case.text
        try:
            for old in [k for k in table if k not in value]:
                del table[old]
            for k, v in value.items():
                if k not in table or table._values()[k] != v:
                    table[k] = v
        except Exception:
            self._case._change(before)
            raise

    def __delitem__(self, key: str) -> None:
        section, last = self._split(key)
        section[last]  # a KeyError if it is not there
        self._case._change(solver().without_key(self._case.name, self._case.text, [*section._path, last]))

    def __iter__(self) -> Iterator[str]:
        return iter(self._values())

    def __len__(self) -> int:
        return len(self._values())

    def to_dict(self) -> dict:
        """The values of this table and the tables in it, as a dict; changing it changes nothing else."""
        return self._values()

    def __repr__(self) -> str:
        return repr(self._values())


class Case(Section):
    """An input file of `talus run`: a path, or the text itself.

        case = talus.Case("cases/slump_2d.toml")
        case["material"]["glass"]["phi_c"] = "30 deg"        # or case["material.glass.phi_c"]
        case["numerics"] = {"cfl": 0.4}                      # a new table
        case.check()                                         # raises InputError with all complaints at once

    Values have the units and ranges of the file; they are checked by `check`, and before a run. `folder` is where files are
    looked for that the case names: by default the folder of the file, or the present one.
    """

    def __init__(self, source: Union[str, os.PathLike], folder: Union[str, os.PathLike, None] = None):
        is_text = isinstance(source, str) and ("\n" in source or "=" in source)
        #: Path of the file; None of a text.
        self.path: Optional[pathlib.Path] = None if is_text else pathlib.Path(source)
        if self.path is not None:
            try:
                self._original = self.path.read_text(encoding="utf-8")
            except (OSError, UnicodeDecodeError) as e:
                raise InputError(f"cannot open {self.path}: {getattr(e, 'strerror', None) or e}") from None
        else:
            self._original = str(source)
        #: Folder that relative paths in the case start from.
        self.folder = pathlib.Path(folder) if folder is not None else self.path.parent if self.path else pathlib.Path()
        self._text = self._original
        self._values_of_text: Optional[dict] = None
        super().__init__(self, ())
        self._parsed()

    def _parsed(self) -> dict:
        if self._values_of_text is None:
            try:
                self._values_of_text = tomllib.loads(self._text)
            except tomllib.TOMLDecodeError as e:
                raise InputError(f"{self.name}: {e}") from None
        return self._values_of_text

    def _values(self) -> dict:
        return self._parsed()

    def _change(self, text: str) -> None:
        before = self._text, self._values_of_text
        self._text, self._values_of_text = text, None
        try:
            self._parsed()
        except InputError:
            self._text, self._values_of_text = before
            raise

    def _is_table_of_lines(self, path: Sequence[str]) -> bool:
        """Whether a table has a header of its own, or tables in it have: no { } in one value."""
        header = "[" + ".".join(path)
        return any(line.strip().replace(" ", "").startswith((header + "]", header + ".")) for line in self._text.splitlines())

    @property
    def text(self) -> str:
        """The text of the input file, with all changes."""
        return self._text

    @property
    def is_changed(self) -> bool:
        """Whether keys were set since the case was read."""
        return self._text != self._original

    def is_its_file(self) -> bool:
        """Whether the file that the case was read from still has its text."""
        return (self.path is not None and self.path.is_file() and self.folder == self.path.parent
                and self.path.read_text(encoding="utf-8") == self._text)

    @property
    def name(self) -> str:
        """What messages call the case."""
        return f"{self.path or 'case'}{' (changed)' if self.is_changed else ''}"

    def to_dict(self) -> dict:
        return tomllib.loads(self._text)

    def copy(self) -> "Case":
        """Another case with the same text."""
        other = Case(self._text, folder=self.folder)
        other.path, other._original = self.path, self._original
        return other

    def check(self) -> dict[str, Setting]:
        """Checks the case as `talus check` does. Returns all settings by their paths ("material.glass.d"), defaults
        included. Raises InputError with every complaint."""
        settings = solver().check_case(self.name, self._text, str(self.folder))
        return {path: Setting(value, default, meaning) for path, value, default, meaning in settings}

    def text_for_other_folder(self) -> str:
        """The text with the paths of files that it names made absolute."""
        return solver().with_absolute_paths(self.name, self._text, str(self.folder))

    def save(self, path: Union[str, os.PathLike]) -> None:
        """Writes the case into a file; paths in it become absolute if the file goes to another folder."""
        path = pathlib.Path(path)
        same = path.parent.resolve() == self.folder.resolve()
        path.write_text(self._text if same else self.text_for_other_folder(), encoding="utf-8")

    def __repr__(self) -> str:
        return f"talus.Case({str(self.path)!r}{', changed' if self.is_changed else ''})" if self.path else "talus.Case(text)"

    def __str__(self) -> str:
        return self._text


def as_case(case: Union[Case, str, os.PathLike]) -> Case:
    return case if isinstance(case, Case) else Case(case)
