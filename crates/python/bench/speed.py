"""Speed of the package beside the command line and the planner, in one run: prints ratios and differences.

    cargo build --profile dist -p standstill-cli --bins --examples
    target/python/tried/bin/python crates/python/bench/speed.py target/dist [SCANS]

A figure is the least of several tries, taken in turn."""

import json
import subprocess
import sys
import tempfile
import time
import timeit
from pathlib import Path

import standstill

TRIES = 9


def script(scans):
    """Four axes there and back, over and over."""
    axes, blocks = {}, []
    for number in range(4):
        axis = f"X{number}"
        axes[axis] = {
            "limits": {"velocity": 100, "acceleration": 1000, "jerk": 20000},
            "state": "Standstill",
        }
        for name, other, target in ((f"out{number}", f"back{number}", 40), (f"back{number}", f"out{number}", 0)):
            execute = {"from": f"{other}.Done"} if name.startswith("back") else {"not": f"{other}.Busy"}
            pins = {"Axis": axis, "Execute": execute, "Position": target, "Velocity": 50}
            blocks.append({"name": name, "type": "MC_MoveAbsolute", "pins": pins})
    return {"standstill": 1, "cycle": "T#1ms", "scans": scans, "axes": axes, "blocks": blocks}


def timed(call):
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def runs(program, scans):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "there.scan.json"
        file.write_text(json.dumps(script(scans)))
        ours, theirs, quiet = [], [], []
        for _ in range(TRIES):
            ours.append(timed(lambda: standstill.run(file)["X0.Position"].max()))
            theirs.append(timed(lambda: subprocess.run([program, "run", file], capture_output=True)))
            quiet.append(timed(lambda: subprocess.run([program, "run", "--quiet", file], capture_output=True)))
    ours, theirs, quiet = min(ours), min(theirs), min(quiet)
    print(f"run of {scans} scans: {1000 * ours:.1f} ms; `standstill run` {1000 * theirs:.1f} ms: {ours / theirs:.2f};"
          f" with --quiet {1000 * quiet:.1f} ms: {ours / quiet:.2f}")


LINES = {
    "overlapped": {"Ts": 0.001, "target": 100.0, "limits": {"velocity": 50.0, "acceleration": 200.0, "jerk": 2000.0}},
    "online, order 3": {
        "Ts": 0.001, "target": 100.0, "method": "online",
        "limits": {"velocity": 50.0, "acceleration": 200.0, "jerk": 2000.0},
    },
    "online, order 4, moving": {
        "Ts": 0.001, "target": 100.0, "velocity": 10.0,
        "limits": {"velocity": 50.0, "acceleration": 200.0, "jerk": 2000.0, "snap": 40000.0},
    },
}


def plans(program, native, count=50_000):
    for name, line in LINES.items():
        called = subprocess.run([native], input=json.dumps(line) + "\n", capture_output=True, text=True, check=True)
        called = int(called.stdout) / 1000
        text = (json.dumps(line) + "\n") * count
        ours, theirs = [], []
        for _ in range(TRIES):
            # Answers are dropped: a list of them all would time Python's search for garbage.
            ours.append(min(timeit.repeat(lambda: standstill.plan(**line), number=count, repeat=1)))
            start = timed(lambda: subprocess.run([program, "plan"], input="", capture_output=True, text=True))
            whole = timed(lambda: subprocess.run([program, "plan"], input=text, stdout=subprocess.DEVNULL, text=True))
            theirs.append(whole - start)
        ours, theirs = 1e6 * min(ours) / count, 1e6 * min(theirs) / count
        print(f"plan, {name}: {ours:.2f} us, the native call {called:.2f} us: {ours - called:.2f} us more;"
              f" a line of `standstill plan` {theirs:.2f} us")
    made = min(timeit.repeat(lambda: dicts(SEGMENTS), number=count, repeat=TRIES))
    print(f"15 dicts of five numbers, made by Python itself: {1e6 * made / count:.2f} us")


SEGMENTS = [(0.1 * place, 1.0 * place, 2.0 * place, 3.0 * place, 4.0 * place) for place in range(15)]


def dicts(segments):
    """What the longest of these answers has in it, at the least cost that Python has for it."""
    return [
        {"duration": duration, "velocity": velocity, "acceleration": acceleration, "jerk": jerk, "snap": snap}
        for duration, velocity, acceleration, jerk, snap in segments
    ]


if __name__ == "__main__":
    built = Path(sys.argv[1])
    runs(built / "standstill", int(sys.argv[2]) if len(sys.argv) > 2 else 100_000)
    plans(built / "standstill", built / "examples" / "plan_natively")
