"""The border between Python and the compiled half under valgrind, which sees memory that is read after its end or beside it."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]

# A column that outlives its run, two runtimes side by side, a callback that raises, refusals with and without a value.
PLAY = """
import gc
import standstill

script = "scan-tests/tutorial/slide.scan.json"
run = standstill.run(script)
column = run["X.Position"]
del run
gc.collect()
assert column[-1] == 40.0 and column.sum() > 0.0
one, two = standstill.Runtime(script), standstill.Runtime(script)
for scan in range(20):
    assert one.scan() == two.scan()
del one
gc.collect()
two.scan()
for wrong in ({"target": "x"}, {"limits": {"velocity": float("nan")}}, {"Ts": 1e-3, "target": 1.0, "limits": {}}):
    try:
        standstill.plan(**wrong)
    except standstill.PlanError as error:
        assert str(error)
    else:
        raise AssertionError(wrong)
try:
    standstill.run_text('{"standstill": 1, ')
except standstill.ScriptError as error:
    assert str(error)
print("played")
"""


def test_no_memory_is_read_or_written_beside_its_place():
    valgrind = shutil.which("valgrind")
    if valgrind is None and not os.environ.get("CI"):
        pytest.skip("valgrind is not installed")
    assert valgrind is not None, "valgrind is not installed"
    played = subprocess.run(
        [valgrind, "--leak-check=no", "--num-callers=40", sys.executable, "-c", PLAY],
        # Objects with a block of memory each, so that a use after their end is seen.
        env={**os.environ, "PYTHONMALLOC": "malloc"},
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert played.returncode == 0 and played.stdout == "played\n", played.stderr
    # The interpreter's constants and the loader's way of comparing texts are reported in any program of Python.
    ours = re.compile(r"standstill_\w+::|_native\.abi3")
    reports = [block for block in played.stderr.split("== \n") if ours.search(block)]
    assert not reports, "\n".join(reports)
