"""What the tests share. They run against the package as it was installed, never against the sources."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest_plugins = ["pytester"]

ROOT = Path(__file__).parents[3]
SCRIPTS = ROOT / "scan-tests"

# The program that the wheel installs.
INSTALLED = Path(sys.executable).with_name("standstill")


def installed(*arguments, folder=None, **options):
    """Runs the installed program."""
    return subprocess.run([INSTALLED, *arguments], cwd=folder, capture_output=True, text=True, **options)


@pytest.fixture
def native():
    """Runs the program as Cargo builds it."""
    program = os.environ.get("STANDSTILL_PROGRAM")
    if program is None:
        pytest.skip("STANDSTILL_PROGRAM names no program")

    def run(*arguments, folder=None, **options):
        return subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True, **options)

    return run


def move(**changes):
    """A script as a dict: one move of 40 mm, begun when GO rises."""
    script = {
        "standstill": 1,
        "title": "There",
        "cycle": "T#1ms",
        "scans": 1200,
        "parameters": {"v": 50},
        "axes": {
            "X": {
                "unit": "mm",
                "limits": {"velocity": 100, "acceleration": 1000, "jerk": 20000},
                "state": "Standstill",
            }
        },
        "inputs": {"GO": False, "level": 0.0},
        "blocks": [
            {
                "name": "there",
                "type": "MC_MoveAbsolute",
                "pins": {"Axis": "X", "Execute": {"from": "GO"}, "Position": 40, "Velocity": {"param": "v"}},
            }
        ],
        "steps": [{"at": 10, "set": {"GO": True}}],
        "expect": [{"by": 1190, "that": {"there.Done": True, "X.Position": 40}}],
    }
    script.update(changes)
    return script
