"""The program in the wheel is the program."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest
from conftest import INSTALLED, ROOT, SCRIPTS, installed, move

COMMANDS = [
    (["run", "scan-tests/mc_move_absolute/second_move_aborts_first.scan.json"], None),
    (["test", "scan-tests/claims", "scan-tests/gallery"], None),
    (["plan"], '{"Ts": 0.001, "target": 1, "limits": {"velocity": 1, "acceleration": 20}}\n{"id": 2}\n'),
    (["blocks", "--json"], None),
    (["run", "nothing.scan.json"], None),
    (["tset"], None),
    (["--help"], None),
    (["--version"], None),
    (["completions", "bash"], None),
]


@pytest.mark.parametrize(("arguments", "text"), COMMANDS, ids=lambda value: " ".join(value) if isinstance(value, list) else "")
def test_same_bytes_and_same_statuses(native, arguments, text):
    environment = {**os.environ, "INSTA_UPDATE": "no"}
    one = native(*arguments, folder=ROOT, input=text, env=environment)
    other = installed(*arguments, folder=ROOT, input=text, env=environment)
    assert (one.stdout, one.returncode) == (other.stdout, other.returncode)
    assert one.stderr == other.stderr


def test_it_is_a_module_too():
    told = subprocess.run([sys.executable, "-m", "standstill", "--version"], capture_output=True, text=True)
    assert told.stdout == installed("--version").stdout


def test_a_closed_pipe_is_quiet():
    program = subprocess.Popen([INSTALLED, "blocks", "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    program.stdout.read(10)
    program.stdout.close()
    assert (program.stderr.read(), program.wait()) == (b"", 0)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_ends_it(tmp_path):
    script = tmp_path / "long.scan.json"
    script.write_text(json.dumps(move(scans=1_000_000_000, steps=[], expect=[])))
    program = subprocess.Popen([INSTALLED, "run", script], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
    time.sleep(0.7)
    program.send_signal(signal.SIGINT)
    _, told = program.communicate(timeout=60)
    assert program.returncode == -signal.SIGINT and b"Traceback" not in told


def test_it_starts_without_numpy():
    loaded = "import sys, standstill._cli; print('numpy' in sys.modules)"
    told = subprocess.run([sys.executable, "-c", loaded], capture_output=True, text=True)
    assert told.stdout == "False\n", told.stderr


def test_the_repository_holds_the_scripts():
    assert SCRIPTS.is_dir()
