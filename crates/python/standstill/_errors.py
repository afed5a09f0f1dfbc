"""What is raised. Files that are not there are an ``OSError`` of Python's own, such as ``FileNotFoundError``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from standstill._run import Trace


class StandstillError(Exception):
    """What all errors of this package have in common."""


@dataclass(frozen=True)
class Diagnostic:
    """One thing that is wrong with a script."""

    code: str
    """What kind; the names do not change."""
    message: str
    """What is wrong, for people."""
    file: str
    """The file it stands in, with ``/``."""
    line: int | None
    """From 1; none where the cause stands in no file."""
    column: int | None
    """From 1, in characters."""
    help: str | None
    """What to do about it."""


class ScriptError(StandstillError, ValueError):
    """A script that cannot be used. As text it is what the command line prints."""

    diagnostics: list[Diagnostic]
    """Everything that is wrong, in the order of the text; at least one."""
    code: str
    """Of the first of them, as are the following."""
    file: str
    line: int | None
    column: int | None
    help: str | None

    def __init__(self, text: str, diagnostics: list[Mapping[str, Any]]) -> None:
        super().__init__(text)
        self.diagnostics = [Diagnostic(**found) for found in diagnostics]
        first = self.diagnostics[0]
        self.code, self.help = first.code, first.help
        self.file, self.line, self.column = first.file, first.line, first.column

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), [vars(found) for found in self.diagnostics])


class RunError(StandstillError, RuntimeError):
    """A run that could not go on."""

    trace: Trace | None
    """The rows so far; none if there was no first scan."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.trace = None


class PlanError(StandstillError, ValueError):
    """A move that was not planned."""

    code: str
    """``invalid_input``, ``too_long``, ``unreachable`` or ``unsupported``."""
    field: str | None
    """The key at fault, such as ``limits.jerk``; none where it is the line as a whole."""
    value: Any
    """What was given there."""
    nearest: float | str | None
    """The nearest value that would have been taken, where there is one."""
    message: str
    """Why, for people."""

    def __init__(self, code: str, field: str | None, value: Any, nearest: float | str | None, message: str) -> None:
        super().__init__(code, field, value, nearest, message)
        self.code, self.field, self.value, self.nearest, self.message = code, field, value, nearest, message

    def __str__(self) -> str:
        told = f"{self.code}: {self.message}"
        return told if self.nearest is None else f"{told}; nearest: {self.nearest}"
