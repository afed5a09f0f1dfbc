"""The guide and the notebook are true: their commands and cells run here and give what stands there.

With STANDSTILL_WRITE_DOCS=1 the results of the notebook are written instead."""

import os
import re
import subprocess
import sys
import time

import nbformat
import pytest
from conftest import ROOT
from nbclient import NotebookClient

PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
NOTEBOOK = ROOT / "docs" / "python.ipynb"


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture(scope="module")
def begun(tmp_path_factory):
    """An empty folder in which the page's three commands were run, with the wheel that is tested."""
    wheel = os.environ.get("STANDSTILL_WHEEL")
    if wheel is None:
        pytest.skip("STANDSTILL_WHEEL names no wheel")
    folder = tmp_path_factory.mktemp("empty")
    commands = [line.removeprefix("$ ") for line in blocks("console")[0].splitlines() if line.startswith("$ ")]
    assert len(commands) <= 3
    built = "pip install target/python/wheels/*.whl"
    assert built in commands
    commands = [command.replace(built, f"pip install --quiet {wheel}") for command in commands]
    # Nothing of the environment of these tests.
    environment = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "VIRTUAL_ENV")}
    base = os.path.join(sys.base_prefix, "bin")
    environment["PATH"] = os.pathsep.join([base, environment.get("PATH", "")])
    begin = time.monotonic()
    told = subprocess.run(
        ["bash", "-ec", "\n".join(commands)], cwd=folder, capture_output=True, text=True, env=environment
    )
    print(f"from nothing to the first passing test: {time.monotonic() - begin:.1f} s")
    assert told.returncode == 0, told.stderr
    return folder, told.stdout


def test_three_commands_lead_to_a_passing_test(begun):
    folder, told = begun
    assert "ok        cell/scan-tests/out_and_back.scan.json" in told
    assert (folder / ".venv").is_dir()


@pytest.mark.parametrize("example", blocks("python"), ids=lambda text: text.splitlines()[2][:30])
def test_what_the_page_shows_runs(begun, example):
    folder, _ = begun
    told = subprocess.run([sys.executable, "-c", example], cwd=folder, capture_output=True, text=True)
    assert told.returncode == 0, told.stderr
    for line in told.stdout.splitlines():
        if line.startswith("Event("):
            assert f"# {line}" in example


def results(notebook):
    """What the cells print and return, as text; the picture of a run is looked at only for being there."""
    told = []
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            told.append(output["text"] if output["output_type"] == "stream" else output["data"]["text/plain"])
    return told


def test_the_notebook_gives_what_stands_in_it():
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    shown = results(notebook)
    NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    html = [output for output in notebook.cells[1].outputs if "<svg" in output["data"].get("text/html", "")]
    assert html, "a run draws itself"
    if os.environ.get("STANDSTILL_WRITE_DOCS"):
        for cell in notebook.cells:
            # Who ran it, and when, is nobody's business.
            cell.metadata.clear()
        notebook.metadata.pop("widgets", None)
        notebook.metadata["language_info"] = {"name": "python"}
        nbformat.write(notebook, NOTEBOOK)
    else:
        assert results(notebook) == shown
