"""Runs of scan scripts, and their rows as arrays."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, NamedTuple

from standstill import _native
from standstill._plain import Source, script_text

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd  # type: ignore[import-untyped, unused-ignore]

# What stands for a script that is no file, in messages.
UNNAMED = "(script)"

# Lines of a trace that a notebook shows.
EVENTS_SHOWN = 12


class Event(NamedTuple):
    """What happened to one axis or instance in one scan."""

    scan: int
    subject: str
    """The axis or instance; ``inputs`` for the input variables, ``run`` for the run as a whole."""
    text: str
    """One line, such as ``+Done -Busy`` or ``Standstill -> DiscreteMotion``."""


class Failure(NamedTuple):
    """One thing that speaks against a claim."""

    scan: int | None
    """The scan it shows in; none if it is about the run as a whole."""
    text: str
    """The words of the command line."""


class Claim(NamedTuple):
    """A claim of a script, judged."""

    path: str
    """Where it stands in the script, such as ``expect[2]``."""
    text: str
    """What it says."""
    passed: bool
    scans: tuple[int, int] | None
    """The first and the last scan it speaks of."""
    held: int | None
    """The scan in which a claim that needs only one came true."""
    failures: list[Failure]
    """What spoke against it; empty if it held."""


class Trace:
    """The rows of a run, as far as it came.

    ``trace[name]`` is a column: float64, bool or str, a value for each scan. Numbers and Booleans are views into the memory the
    run was recorded in; they can be read only.
    """

    def __init__(self, rows: _native.Rows) -> None:
        self._rows = rows
        self._kinds = dict(rows.columns())
        self._words: np.ndarray[Any, Any] | None = None
        self._names: list[str] = []
        self._events: list[Event] | None = None
        self.title, self._cycle_ns, axes = rows.about()
        self.units: dict[str, str] = dict(axes)
        """The unit of each axis."""

    @property
    def names(self) -> list[str]:
        """Names of the columns, in the order of trace files."""
        return list(self._kinds)

    @property
    def cycle(self) -> float:
        """Time of a scan (s)."""
        return self._cycle_ns / 1e9

    @property
    def digest(self) -> str:
        """One number for every bit of the run, as ``standstill run`` prints it."""
        return self._rows.digest

    @property
    def events(self) -> list[Event]:
        """What happened, in the order of cause and effect."""
        if self._events is None:
            self._events = [Event(*event) for event in self._rows.events()]
        return self._events

    def __len__(self) -> int:
        """Scans."""
        return len(self._lent())

    def __contains__(self, name: object) -> bool:
        return name in self._kinds or name in ("scan", "time_ns")

    def __iter__(self) -> Iterator[str]:
        return iter(self._kinds)

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        """A column by its name in trace files; ``scan`` and ``time_ns`` are there, too. Case does not count."""
        import numpy as np

        if name in ("scan", "time_ns"):
            each = 1 if name == "scan" else self._cycle_ns
            return np.arange(len(self), dtype=np.float64) * each
        name = spelled(name, self._kinds)
        words = self._lent()
        place = list(self._kinds).index(name)
        kind = self._kinds[name]
        if kind == "real":
            return words.view(np.float64)[:, place]
        if kind == "bool":
            # A word is 0 or 1; its low byte says so, which is the first on every processor that is supported.
            return words.view(np.bool_)[:, 8 * place]
        if kind == "integer":
            return words.view(np.int64)[:, place].astype(np.float64)
        used, of_rows = np.unique(words[:, place], return_inverse=True)
        texts = [self._names[word] for word in used]
        return np.array(texts, dtype=np.str_)[of_rows]

    def _lent(self) -> np.ndarray[Any, Any]:
        """The rows, a word a cell."""
        if self._words is None:
            words = self._rows.words()
            self._names = self._rows.names()
            self._words = words.reshape(-1, max(len(self._kinds), 1))
        return self._words

    def to_pandas(self) -> pd.DataFrame:
        """A table with the columns of a trace file: ``scan``, ``time_ns``, then every signal. It needs the package pandas."""
        import numpy as np
        import pandas as pd

        scans = np.arange(len(self), dtype=np.int64)
        columns: dict[str, Any] = {"scan": scans, "time_ns": scans * self._cycle_ns}
        columns.update((name, self[name]) for name in self._kinds)
        return pd.DataFrame(columns)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a ``.csv`` or ``.jsonl`` file, as ``standstill run --trace`` does."""
        self._rows.save(Path(path))

    def svg(self, signals: Iterable[str] = ("Position", "Velocity")) -> str:
        """The picture of a run: these signals of every axis, and every Boolean that changes."""
        return self._rows.svg(list(signals))

    def _summary(self) -> str:
        return f"{len(self)} scans, digest {self.digest}"

    def __repr__(self) -> str:
        return f"<standstill.{type(self).__name__} {self.title or UNNAMED}: {self._summary()}>"

    def _repr_html_(self) -> str:
        from html import escape

        shown = "".join(f"{scan:>6}  {subject}  {text}\n" for scan, subject, text in self.events[:EVENTS_SHOWN])
        more = len(self.events) - EVENTS_SHOWN
        if more > 0:
            shown += f"   and {more} more in .events\n"
        head = f"<b>{escape(self.title or UNNAMED)}</b>: {escape(self._summary())}"
        return f'<div style="max-width: 60em">{head}{self.svg()}<pre>{escape(shown)}</pre></div>'


class Run(Trace):
    """A run that came to its end, with its claims judged."""

    def __init__(self, rows: _native.Rows) -> None:
        super().__init__(rows)
        self.claims: list[Claim] = [
            Claim(path, text, passed, (scans[0], scans[1]) if scans else None, held, [Failure(*found) for found in failures])
            for path, text, passed, scans, held, failures in rows.claims
        ]
        """In the order of the script."""
        self.why: list[str] = rows.why
        """What is behind claims that fail, the likeliest first."""
        self.warnings: list[str] = rows.warnings
        """What the script says to no effect, and what was changed on its way."""

    @property
    def passed(self) -> bool:
        """Whether every claim held."""
        return all(claim.passed for claim in self.claims)

    def _summary(self) -> str:
        return self._rows.verdict or super()._summary()


def run(
    script: str | os.PathLike[str] | Mapping[str, Any],
    set: Mapping[str, float] | None = None,
    *,
    folder: str | os.PathLike[str] | None = None,
    include_from: Iterable[str | os.PathLike[str]] = (),
    guest_memory: int | None = None,
    drives: Mapping[str, Callable[..., float]] | None = None,
) -> Run:
    """Runs a script to its end and judges its claims. A claim that fails is no exception: see :attr:`Run.passed`.

    :param script: a path, or a script as a dict
    :param set: values in place of the script's own parameters
    :param folder: where the files are that a dict names; without it the working folder. Files that a script names lie in
        its own folder or below
    :param include_from: further folders that files may lie in
    :param guest_memory: what the script's programs may have together (bytes)
    :param drives: drives of your own, by axis; see :class:`standstill.Runtime`
    :raises ScriptError: the script cannot be used
    :raises RunError: it could not go on; its ``trace`` has the rows so far
    :raises OSError: a file cannot be read
    """
    if not drives:
        return _ran(source_of(script, set, folder, include_from, guest_memory))
    from standstill._runtime import Runtime

    files: dict[str, Any] = {"folder": folder, "include_from": include_from, "guest_memory": guest_memory}
    return Runtime(script, set, **files, drives=drives).finish()


def run_text(
    text: str,
    set: Mapping[str, float] | None = None,
    *,
    folder: str | os.PathLike[str] | None = None,
    include_from: Iterable[str | os.PathLike[str]] = (),
    guest_memory: int | None = None,
) -> Run:
    """Runs a script that is a text of JSON; else as :func:`run`."""
    if not isinstance(text, str):
        raise TypeError(f"run_text takes JSON as a str, not {type(text).__name__}; `run` takes paths and dicts")
    return _ran((_place(folder), text, *_rest(set, include_from, guest_memory)))


def _ran(source: Source) -> Run:
    rows, error = _native.run(source)
    if error is not None:
        # Nothing of the run so far is lost.
        error.trace = Trace(rows)  # type: ignore[attr-defined]
        raise error
    return Run(rows)


def source_of(
    script: str | os.PathLike[str] | Mapping[str, Any],
    set: Mapping[str, float] | None,
    folder: str | os.PathLike[str] | None,
    include_from: Iterable[str | os.PathLike[str]],
    guest_memory: int | None,
) -> Source:
    """Where a script comes from, as the compiled half takes it."""
    rest = _rest(set, include_from, guest_memory)
    if isinstance(script, Mapping):
        return (_place(folder), script_text(script), *rest)
    if not isinstance(script, (str, os.PathLike)):
        raise TypeError(f"a script is a path or a dict, not {type(script).__name__}; `run_text` takes JSON")
    if folder is not None:
        raise TypeError("folder is for a script that is a dict: a file has its own")
    if isinstance(script, str) and script.lstrip().startswith("{"):
        raise ValueError("a str is the path of a script, and this looks like the script itself: `run_text` takes JSON")
    return (Path(script), None, *rest)


def _place(folder: str | os.PathLike[str] | None) -> Path:
    return Path(UNNAMED) if folder is None else Path(folder) / UNNAMED


def _rest(
    set: Mapping[str, float] | None,
    include_from: Iterable[str | os.PathLike[str]],
    guest_memory: int | None,
) -> tuple[list[tuple[str, float]], list[Path], int | None]:
    values = []
    for name, value in (set or {}).items():
        try:
            values.append((name, float(value)))
        except (TypeError, ValueError):
            raise TypeError(f"set: {name} is a number, not {value!r}") from None
    return values, [Path(path) for path in include_from], guest_memory


def spelled(name: str, signals: Mapping[str, Any]) -> str:
    """The name of a signal as the trace spells it.

    :raises KeyError: there is no such signal
    """
    if name in signals:
        return name
    if isinstance(name, str):
        for known in signals:
            if known.lower() == name.lower():
                return known
    raise KeyError(f"there is no signal {name!r}{did_you_mean(name, signals)}")


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """A hint at the nearest name, if there is one."""
    from difflib import get_close_matches

    lower = {word.lower(): word for word in known}
    near = get_close_matches(str(name).lower(), lower, n=1)
    return f"; did you mean {lower[near[0]]!r}?" if near else ""
