"""What can go wrong."""

from __future__ import annotations

from typing import NamedTuple, Optional, Sequence


class Complaint(NamedTuple):
    """One mistake in an input. Lines and columns count from 1; 0 where the input as a whole is meant."""

    file: str
    line: int
    column: int
    text: str


class InputError(ValueError):
    """The input is wrong. The message has all complaints at once, in the order of the file; `complaints` has them one by
    one."""

    complaints: tuple[Complaint, ...]

    def __init__(self, message: str, complaints: Sequence[Complaint] = ()):
        super().__init__(message)
        self.complaints = tuple(complaints) or tuple(Complaint("", 0, 0, line) for line in message.splitlines())


class RunError(RuntimeError):
    """A run or an element test failed. `particle` is the id of the particle where it showed, if it is known; `result` has
    what was computed before, of an element test."""

    def __init__(self, message: str, particle: Optional[int] = None, result=None):
        super().__init__(message)
        self.particle = particle
        self.result = result
