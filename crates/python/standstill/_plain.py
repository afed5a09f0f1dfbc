"""Values of Python as the JSON that scripts and lines are made of."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

# Where a script comes from, as the compiled half takes it: path, text (else the file at the path), parameters, further folders
# for files, memory of guests (bytes).
Source = tuple[Path, str | None, list[tuple[str, float]], list[Path], int | None]


def plain(value: Any, place: str = "") -> Any:
    """The value with nothing in it but what JSON has: arrays become lists, scalars of NumPy numbers, NaN and the infinities
    the words for them, paths texts.

    :raises TypeError: with the place of what JSON has no form for
    """
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise TypeError(f"{place or 'the script'}: keys are texts, not {type(key).__name__} ({key!r})")
        return {key: plain(inner, f"{place}.{key}" if place else key) for key, inner in value.items()}
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        if math.isfinite(value):
            return float(value)
        return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    if isinstance(value, (list, tuple)):
        return [plain(inner, f"{place}[{index}]") for index, inner in enumerate(value)]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    # Arrays and scalars of NumPy, columns of pandas.
    if hasattr(value, "tolist"):
        return plain(value.tolist(), place)
    raise TypeError(f"{place or 'the script'}: {type(value).__name__} has no form in JSON")


def json_of(value: Any) -> str:
    """A value on one line."""
    return json.dumps(plain(value), ensure_ascii=False)


def script_text(script: Mapping[str, Any]) -> str:
    """A script as a text whose lines can be pointed at."""
    return json.dumps(plain(script), ensure_ascii=False, indent=2) + "\n"
