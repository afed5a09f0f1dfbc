"""A run scan by scan: inputs and drives of your own."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Mapping
from typing import Any, Callable, NamedTuple

from standstill import _native
from standstill._errors import RunError
from standstill._plain import script_text
from standstill._run import Run, Trace, source_of, spelled


class Command(NamedTuple):
    """What an axis asked of its drive at the end of the scan before, in the drive's own coordinates: MC_Home and
    MC_SetPosition do not move them."""

    scan: int
    """The scan the drive's position is wanted for."""
    request: str
    """Of the power stage: ``off``, ``enable``, ``quick_stop`` or ``fault_reset``."""
    position: float
    """Where the drive is to be (u)."""
    velocity: float
    """With which velocity (u/s)."""


Drive = Callable[[Command], float]


class Runtime:
    """A script that Python takes scan by scan.

    :param script: a path, or a script as a dict; this and what follows as for :func:`standstill.run`
    :param drives: drives of your own, by axis: called in every scan with the :class:`Command` of the scan before, and return
        where the axis is now (u). Power and faults stay those of the drive in the script

    A Runtime belongs to the thread of its first scan, until that thread calls :meth:`release` or ends.
    """

    def __init__(
        self,
        script: str | os.PathLike[str] | Mapping[str, Any],
        set: Mapping[str, float] | None = None,
        *,
        folder: str | os.PathLike[str] | None = None,
        include_from: Iterable[str | os.PathLike[str]] = (),
        guest_memory: int | None = None,
        drives: Mapping[str, Drive] | None = None,
    ) -> None:
        self._script = script
        self._scans = _native.Scans(source_of(script, set, folder, include_from, guest_memory))
        self._drives = dict(drives or {})
        for axis, drive in self._drives.items():
            self._scans.ordered(axis)
            if not callable(drive):
                raise TypeError(f"drives: {axis} is called with a Command, so a {type(drive).__name__} does not do")
        self._busy = threading.Lock()
        self._owner: threading.Thread | None = None
        self._ended: BaseException | None = None

    def scan(self, inputs: Mapping[str, Any] | None = None) -> dict[str, bool | int | float | str]:
        """Writes inputs, calls the drives, does the next scan, and returns what every signal was in it.

        :param inputs: values of input variables, of pins that nothing is wired to (``instance.Pin``) and of a program's
            variables. They stay as they are until they are written again; all are written or none
        :raises RunError: the run is over, or could not go on
        :raises KeyError: there is no such input
        :raises ValueError: an input does not take this value
        :raises RuntimeError: another thread has this Runtime
        """
        with self._mine():
            if self._ended is not None:
                raise RunError(f"the run ended in scan {self.scans}: {self._ended!r}")
            try:
                return self._scanned(inputs)
            except (KeyError, TypeError, ValueError) as error:
                # What was given is at fault and nothing was done, unless a drive says so.
                if getattr(error, "_of_drive", False):
                    self._end(error)
                raise
            except BaseException as error:
                self._end(error)
                raise

    def _scanned(self, inputs: Mapping[str, Any] | None) -> dict[str, bool | int | float | str]:
        scan, over = self._scans.progress()
        if over:
            error = RunError(f"the run is over after {scan} scans: `scans` and `stop_when` of the script say so")
            error.trace = self.trace
            raise error
        # What was given is looked at before a drive is called: a drive is called once for each scan.
        if inputs:
            self._scans.write({name: scalar(name, value) for name, value in inputs.items()})
        for axis, drive in self._drives.items():
            self._lead(scan, axis, drive)
        signals = self._scans.scan()
        assert signals is not None, "the run was not over"
        return signals

    def _lead(self, scan: int, axis: str, drive: Drive) -> None:
        """Calls a drive, and puts the axis where it says."""
        try:
            position = drive(Command(scan, *self._scans.ordered(axis)))
            try:
                position = float(position)
            except (TypeError, ValueError):
                raise TypeError(f"the position is {position!r}: one number is wanted") from None
            self._scans.lead(axis, position)
        except BaseException as error:
            error._of_drive = True  # type: ignore[attr-defined]
            note = f"raised by the drive of {axis} in scan {scan}; the rows before it are in .trace of this exception"
            if hasattr(error, "add_note"):
                error.add_note(note)
            raise

    def _end(self, error: BaseException) -> None:
        self._ended = error
        error.trace = self.trace  # type: ignore[attr-defined]

    def _mine(self) -> _Held:
        return _Held(self)

    def __getitem__(self, name: str) -> bool | int | float | str:
        """What a signal was in the last scan."""
        signals = self.signals
        if not signals:
            raise KeyError(f"{name}: there was no scan yet")
        return signals[spelled(name, signals)]

    @property
    def signals(self) -> dict[str, bool | int | float | str]:
        """What every signal was in the last scan; empty before the first."""
        return self._scans.signals()

    @property
    def inputs(self) -> list[str]:
        """Names that inputs of :meth:`scan` may have."""
        return self._scans.settable()

    @property
    def scans(self) -> int:
        """Scans done."""
        return self._scans.progress()[0]

    @property
    def is_over(self) -> bool:
        """Whether there is no further scan."""
        return self._ended is not None or self._scans.progress()[1]

    @property
    def trace(self) -> Trace:
        """A copy of the rows so far."""
        return Trace(self._scans.rows())

    def fault(self, axis: str, kind: str = "drive", code: int = 0) -> None:
        """Makes an axis or its drive fail in the next scan, as a step ``fault`` does.

        :param kind: ``drive``, ``power``, ``communication`` or ``axis``
        :param code: the drive's own number
        """
        with self._mine():
            self._scans.fault(axis, kind, code)

    def clear(self, axis: str) -> None:
        """The cause of a fault is gone; MC_Reset is still needed."""
        with self._mine():
            self._scans.fault(axis, None, 0)

    def as_script(self) -> str:
        """The script with the inputs so far as steps: a text whose run is this one, but for drives of your own."""
        if isinstance(self._script, Mapping):
            text = script_text(self._script)
        else:
            with open(self._script, encoding="utf-8-sig") as file:
                text = file.read()
        return self._scans.as_script(text)

    def finish(self) -> Run:
        """Goes on to the end of the run, and judges its claims."""
        while self._drives and not self.is_over:
            self.scan()
        with self._mine():
            if self._ended is not None:
                raise RunError(f"the run ended in scan {self.scans}: {self._ended!r}")
            return Run(self._scans.finish())

    def release(self) -> None:
        """Lets another thread have it: the one that scans next."""
        with self._mine():
            self._owner = None


class _Held:
    """One call of a Runtime by the thread it belongs to."""

    def __init__(self, runtime: Runtime) -> None:
        self.runtime = runtime

    def __enter__(self) -> None:
        runtime, here = self.runtime, threading.current_thread()
        if not runtime._busy.acquire(blocking=False):
            raise RuntimeError(
                f"this Runtime is in scan {runtime.scans} already, called by thread {_name(runtime._owner)}: "
                "one scan at a time, and a drive cannot scan the Runtime that calls it"
            )
        owner = runtime._owner
        if owner is not None and owner is not here and owner.is_alive():
            runtime._busy.release()
            raise RuntimeError(
                f"this Runtime belongs to thread {_name(owner)} since its first scan, and thread {_name(here)} wants it: "
                "give each thread its own Runtime, or let the first `release` it"
            )
        runtime._owner = here

    def __exit__(self, *_: object) -> None:
        self.runtime._busy.release()


def _name(thread: threading.Thread | None) -> str:
    return "?" if thread is None else thread.name


def scalar(name: str, value: Any) -> bool | int | float | str:
    """An input as a plain value; scalars of NumPy and arrays of one element without a dimension are some."""
    if isinstance(value, (bool, int, float, str)):
        return value
    if getattr(value, "shape", None) == () and hasattr(value, "item"):
        return scalar(name, value.item())
    if hasattr(value, "shape"):
        raise ValueError(f"{name}: one value is wanted, not an array of shape {tuple(value.shape)}")
    raise TypeError(f"{name}: a bool, a number or a text is wanted, not {type(value).__name__}")
