"""PLCopen motion, scan by scan: run scan scripts, plan moves, step a runtime from Python.

>>> import standstill
>>> run = standstill.run("cell.scan.json", set={"v": 60})
>>> run["X.Position"], run.passed, run.digest

Units and keys are those of the command line: https://docs.rs/standstill-cli has it, ``standstill --help`` tells of it.
"""

from standstill._errors import Diagnostic, PlanError, RunError, ScriptError, StandstillError
from standstill._native import __version__, plan
from standstill._run import Claim, Event, Failure, Run, Trace, run, run_text
from standstill._runtime import Command, Runtime

__all__ = [
    "Claim",
    "Command",
    "Diagnostic",
    "Event",
    "Failure",
    "PlanError",
    "Run",
    "RunError",
    "Runtime",
    "ScriptError",
    "StandstillError",
    "Trace",
    "__version__",
    "plan",
    "run",
    "run_text",
]
