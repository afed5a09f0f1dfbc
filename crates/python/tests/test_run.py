"""`run`: the same bits as the command line, columns as arrays, and exceptions that say where."""

import json
import os
import re
import signal
import subprocess
import sys
import textwrap
import threading

import numpy as np
import pandas as pd
import pytest
from conftest import SCRIPTS, installed, move

import standstill

ALIKE = [
    "mc_move_absolute/second_move_aborts_first.scan.json",
    # What stands in other files: a machine, a table, a program in Structured Text.
    "fault_matrix/plant_drive_fault.scan.json",
    "gallery/filler.scan.json",
    "gallery/packer.scan.json",
]


def some_scripts():
    named = [SCRIPTS / name for name in ALIKE if (SCRIPTS / name).exists()]
    assert len(named) >= 4, "the scripts have other names"
    return named + sorted((SCRIPTS / "claims").glob("*.scan.json"))


@pytest.mark.parametrize("script", some_scripts(), ids=lambda path: path.name)
def test_a_run_ends_with_the_words_and_the_digest_of_the_command_line(script):
    run = standstill.run(script)
    told = installed("run", "--quiet", str(script))
    last = told.stdout.splitlines()[-1]
    assert last == f"{script}: {run._rows.verdict}"
    assert last.endswith(f"digest {run.digest}")
    assert run.passed == (told.returncode == 0)


def test_a_file_a_dict_and_a_text_are_one_run(tmp_path):
    file = tmp_path / "there.scan.json"
    file.write_text(json.dumps(move()))
    runs = [
        standstill.run(file),
        standstill.run(str(file)),
        standstill.run(move()),
        standstill.run_text(json.dumps(move())),
    ]
    assert len({run.digest for run in runs}) == 1
    assert all(run.passed and len(run) == 1200 for run in runs)


# `plc_scan`, which does nothing, and a page of memory.
MODULE = (
    b"\0asm\1\0\0\0"
    b"\x01\x06\x01\x60\x02\x7f\x7e\x00"  # a type: (i32, i64)
    b"\x03\x02\x01\x00"  # a function of it
    b"\x05\x03\x01\x00\x01"  # a page
    b"\x07\x15\x02\x08plc_scan\x00\x00\x06memory\x02\x00"
    b"\x0a\x04\x01\x02\x00\x0b"  # its body: the end
)


def test_a_program_in_webassembly_runs_and_as_text_has_to_be_translated(tmp_path):
    (tmp_path / "idle.wasm").write_bytes(MODULE)
    (tmp_path / "idle.wat").write_text("(module)")
    file = tmp_path / "guest.scan.json"
    file.write_text(json.dumps(move(programs={"main": {"wasm": "idle.wasm"}})))
    run = standstill.run(file)
    assert installed("run", "--quiet", str(file)).stdout.splitlines()[-1].endswith(f"digest {run.digest}")
    file.write_text(json.dumps(move(programs={"main": {"wasm": "idle.wat"}})))
    with pytest.raises(standstill.ScriptError, match="wat2wasm"):
        standstill.run(file)


def test_columns_are_arrays_that_are_lent_not_copied():
    run = standstill.run(move())
    position, done, state = run["X.Position"], run["there.Done"], run["X.State"]
    assert (position.dtype, done.dtype, state.dtype.kind) == (np.float64, np.bool_, "U")
    assert position.shape == done.shape == state.shape == (1200,)
    assert np.shares_memory(position, run["X.Position"]) and np.shares_memory(done, run["there.Done"])
    assert not position.flags.owndata and not position.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        position[0] = 1
    with pytest.raises(ValueError):
        position.base.setflags(write=True)
    # The memory outlives the run.
    del run
    assert position[-1] == 40 and done[-1] and not done[0]
    assert set(state) == {"Standstill", "DiscreteMotion"}


def test_whole_numbers_times_and_scans_are_columns_too():
    run = standstill.run(move())
    assert run["there.ErrorID"].dtype == np.float64 and not run["there.ErrorID"].any()
    assert run["scan"][-1] == 1199 and run["time_ns"][1] == 1e6
    assert run["x.position"][-1] == 40, "case does not count"
    assert run.names[0] == "X.State" and "GO" in run and len(list(run)) == len(run.names)
    with pytest.raises(KeyError, match="there is no signal 'X.Positon'; did you mean 'X.Position'"):
        run["X.Positon"]


def test_a_table_is_the_trace_file(tmp_path):
    script = SCRIPTS / "gallery" / "packer.scan.json"
    file = tmp_path / "run.csv"
    standstill.run(script).save(file)
    saved = tmp_path / "program.csv"
    assert installed("run", "--quiet", str(script), "--trace", str(saved)).returncode == 0
    assert file.read_bytes() == saved.read_bytes()
    read = pd.read_csv(saved, keep_default_na=False)
    frame = standstill.run(script).to_pandas()
    assert list(frame.columns) == list(read.columns)
    for name in frame.columns:
        expected, found = read[name], frame[name]
        if expected.dtype == object or expected.dtype.kind not in "bif":
            expected, found = expected.astype(str), found.astype(str)
        assert (np.asarray(expected) == np.asarray(found)).all(), name


def test_events_and_claims_are_those_of_the_command_line(tmp_path):
    run = standstill.run(move())
    begun = run.events.index((10, "inputs", "+GO"))
    assert run.events[begun + 1].subject == "there" and "+Busy" in run.events[begun + 1].text
    file = tmp_path / "there.scan.json"
    file.write_text(json.dumps(move()))
    shown = installed("run", str(file)).stdout.split("\nevents\n")[1].split("\n\n")[0].splitlines()
    assert [line.split(maxsplit=2) for line in shown] == [[str(scan), *rest] for scan, *rest in run.events]
    [claim] = run.claims
    assert (claim.path, claim.passed, claim.failures) == ("expect[0]", True, [])
    late = standstill.run(move(), set={"v": 1})
    assert not late.passed and late.claims[0].failures[0].text.startswith("expect[0]")
    assert late.why, "a failing run says what is behind it"


def test_parameters_are_set():
    fast, slow = standstill.run(move()), standstill.run(move(), set={"v": np.float64(40)})
    assert fast["X.Velocity"].max() == 50 and slow["X.Velocity"].max() == 40
    with pytest.raises(standstill.ScriptError, match="w") as wrong:
        standstill.run(move(), set={"w": 1})
    assert wrong.value.code == "unknown_parameter"
    with pytest.raises(TypeError, match="set: v is a number"):
        standstill.run(move(), set={"v": "fast"})


def test_a_mistake_is_told_with_file_line_and_column(tmp_path):
    file = tmp_path / "wrong.scan.json"
    text = json.dumps(move(), indent=2).replace('"Execute"', '"Exceute"')
    file.write_text(text)
    with pytest.raises(standstill.ScriptError) as wrong:
        standstill.run(file)
    error = wrong.value
    line = next(number for number, line in enumerate(text.splitlines(), 1) if "Exceute" in line)
    assert (error.code, error.line, error.column) == ("unknown_pin", line, text.splitlines()[line - 1].index('"') + 1)
    assert error.file == file.as_posix() and "Execute" in str(error)
    assert isinstance(error, ValueError) and error.diagnostics[0].line == line
    # The words are those of the command line.
    assert installed("run", str(file)).stderr.strip() == str(error).strip()
    # Of a text and of a dict there is a line as well.
    with pytest.raises(standstill.ScriptError) as wrong:
        standstill.run_text('{"standstill": 1,\n "cycle" "T#1ms"}')
    assert (wrong.value.code, wrong.value.line, wrong.value.file) == ("syntax", 2, "(script)")


def test_arrays_of_a_wrong_shape_and_numbers_that_are_none():
    assert standstill.run(move(parameters={"v": np.float32(25)}))["X.Velocity"].max() == 25
    axes = move()["axes"]
    axes["X"]["position"] = np.zeros(3)
    with pytest.raises(standstill.ScriptError) as wrong:
        standstill.run(move(axes=axes))
    assert (wrong.value.code, wrong.value.file) == ("wrong_type", "(script)") and wrong.value.line > 1
    axes["X"]["position"] = float("nan")
    with pytest.raises(standstill.ScriptError, match="position") as wrong:
        standstill.run(move(axes=axes))
    assert wrong.value.line > 1
    with pytest.raises(TypeError, match=re.escape("steps[0].at: object has no form in JSON")):
        standstill.run(move(steps=[{"at": object()}]))
    with pytest.raises(TypeError, match="keys are texts"):
        standstill.run({1: 2})


def test_what_is_no_script(tmp_path):
    with pytest.raises(FileNotFoundError) as missing:
        standstill.run(tmp_path / "nothing.scan.json")
    assert missing.value.filename == str(tmp_path / "nothing.scan.json")
    with pytest.raises(OSError):
        standstill.run(tmp_path)
    with pytest.raises(ValueError, match="run_text"):
        standstill.run(json.dumps(move()))
    with pytest.raises(TypeError, match="a path or a dict, not int"):
        standstill.run(3)
    with pytest.raises(TypeError, match="run_text takes JSON"):
        standstill.run_text(move())
    latin = tmp_path / "latin.scan.json"
    latin.write_bytes('{"title": "Ä"}'.encode("latin-1"))
    with pytest.raises(standstill.ScriptError, match="not UTF-8") as wrong:
        standstill.run(latin)
    assert (wrong.value.code, wrong.value.line) == ("encoding", None)


def test_files_are_looked_for_beside_the_script_or_in_the_folder_given(tmp_path, monkeypatch):
    axes = move()["axes"]
    (tmp_path / "one.machine.json").write_text(json.dumps({"standstill": 1, "axes": axes}))
    script = move(include="one.machine.json", axes={})
    assert standstill.run(script, folder=tmp_path).passed
    with pytest.raises(standstill.ScriptError) as wrong:
        standstill.run(script)
    assert wrong.value.code == "bad_include"
    monkeypatch.chdir(tmp_path)
    assert standstill.run(script).passed
    with pytest.raises(TypeError, match="a file has its own"):
        standstill.run("one.scan.json", folder=tmp_path)


def test_a_run_shows_itself():
    run = standstill.run(move())
    assert repr(run) == f"<standstill.Run There: {run._rows.verdict}>"
    html = run._repr_html_()
    assert "<svg" in html and "+GO" in html and "<script" not in html
    # Looking at the picture takes nothing from the columns.
    assert run["X.Position"][-1] == 40 and len(run.events) > 3


LONG = """
    import signal, standstill
    from conftest import move
    signal.signal(signal.SIGINT, signal.default_int_handler)
    script = move(scans=1_000_000)
    # Enough work that it is not over when the signal comes.
    for number in range(9):
        script["axes"][f"Y{number}"] = script["axes"]["X"]
    print("begun", flush=True)
    try:
        standstill.run(script)
    except KeyboardInterrupt as stopped:
        trace = stopped.trace
        print(0 < len(trace) < 1_000_000, trace["X.Position"].shape == (len(trace),))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_ends_a_long_run_and_keeps_its_rows():
    child = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(LONG)],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(SCRIPTS.parent / "crates/python/tests")},
    )
    assert child.stdout.readline() == "begun\n"
    timer = threading.Timer(0.4, child.send_signal, [signal.SIGINT])
    timer.start()
    told, _ = child.communicate(timeout=120)
    assert (told, child.returncode) == ("True True\n", 0)


def test_other_threads_go_on_while_a_run_is_on():
    ticks, over = [], threading.Event()

    def count():
        while not over.is_set():
            ticks.append(len(ticks))
            over.wait(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = len(ticks)
    standstill.run(move(scans=60_000, steps=[], expect=[]))
    during = len(ticks) - before
    over.set()
    thread.join()
    assert during > 5
