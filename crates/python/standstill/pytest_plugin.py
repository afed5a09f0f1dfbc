"""Scan scripts as tests: every ``*.scan.json`` that pytest finds is run, and held against its claims and its golden as
``standstill test`` does. Nothing is written."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from standstill import _native
from standstill._errors import ScriptError, StandstillError

ENDING = ".scan.json"


class ScriptFailed(Exception):
    """A claim or the golden of a script fails; as text what the command line says of it."""


class ScriptItem(pytest.Item):
    """The test that a script is."""

    def runtest(self) -> None:
        folders: list[Path] = self.config.getini("standstill_include_from")
        passed, text, warnings = _native.judge(self.path, folders)
        if warnings:
            self.add_report_section("call", "standstill", warnings)
        if not passed:
            raise ScriptFailed(text)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        error = excinfo.value
        # How Python came here says nothing about the script.
        if isinstance(error, (ScriptFailed, ScriptError, StandstillError, OSError)):
            return str(error).rstrip()
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, None, self.name


class ScriptFile(pytest.File):
    """A script."""

    def collect(self) -> Iterator[ScriptItem]:
        yield ScriptItem.from_parent(self, name=self.path.name.removesuffix(ENDING))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addini(
        "standstill_include_from",
        "further folders that files of scan scripts may lie in, as --include-from of `standstill test`",
        type="paths",
        default=[],
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ScriptFile | None:
    if file_path.name.endswith(ENDING):
        return ScriptFile.from_parent(parent, path=file_path)
    return None
