"""`Runtime`: scan by scan, with inputs and drives of one's own."""

import threading

import numpy as np
import pytest
from conftest import SCRIPTS, move

import standstill


def test_scan_by_scan_is_the_run():
    runtime = standstill.Runtime(move())
    rows = []
    while not runtime.is_over:
        rows.append(runtime.scan())
    run = standstill.run(move())
    assert len(rows) == runtime.scans == 1200
    assert [row["X.Position"] for row in rows] == run["X.Position"].tolist()
    assert rows[-1]["there.Done"] is True and rows[0]["X.State"] == "Standstill" and rows[-1]["there.ErrorID"] == 0
    assert list(rows[0]) == run.names
    finished = runtime.finish()
    assert finished.digest == run.digest and finished.passed
    with pytest.raises(RuntimeError, match="finished"):
        runtime.signals


def test_inputs_stay_until_they_are_written_again():
    runtime = standstill.Runtime(move(steps=[]))
    assert runtime.scan()["GO"] is False
    assert runtime.scan({"GO": True, "level": 2})["level"] == 2.0
    assert runtime.scan(inputs={})["GO"] is True and runtime["go"] is True
    assert runtime["there.Busy"] is True
    assert runtime.scan({"level": np.float64(0.1)})["level"] == 0.1
    assert "there.BufferMode" in runtime.inputs and "there.Execute" not in runtime.inputs
    assert runtime.scan({"there.BufferMode": "mcBuffered"})["there.BufferMode"] == "mcBuffered"


@pytest.mark.parametrize(
    ("inputs", "kind", "words"),
    [
        ({"Go_": True}, KeyError, "Go_: there is no such input; there are GO, level"),
        ({"GO": 3}, ValueError, "GO: `3` is neither TRUE nor FALSE"),
        ({"GO": np.array([True, False])}, ValueError, r"GO: one value is wanted, not an array of shape \(2,\)"),
        ({"GO": None}, TypeError, "GO: a bool, a number or a text is wanted, not NoneType"),
        ({"level": "much"}, ValueError, "level: `much` is no number"),
        ({"there.Done": True}, ValueError, "there.Done: it is an output"),
        ({"there.Execute": True}, ValueError, "there.Execute: it is wired"),
    ],
)
def test_an_input_that_cannot_be_written_changes_nothing(inputs, kind, words):
    runtime = standstill.Runtime(move(steps=[]))
    runtime.scan()
    with pytest.raises(kind, match=words):
        runtime.scan({"level": 7, **inputs})
    assert runtime.scans == 1
    assert runtime.scan()["level"] == 0.0, "nothing of it was written"


def test_the_end_of_a_run_is_an_exception():
    runtime = standstill.Runtime(move(scans=3, steps=[], expect=[]))
    for _ in range(3):
        runtime.scan()
    with pytest.raises(standstill.RunError, match="the run is over after 3 scans") as over:
        runtime.scan()
    assert len(over.value.trace) == 3


def lagging(lag):
    """A drive of first order."""
    place = 0.0

    def drive(command):
        nonlocal place
        place += lag * (command.position - place)
        return place

    return drive


def test_a_drive_of_ones_own_is_where_it_says():
    runtime = standstill.Runtime(move(), drives={"X": lagging(0.1)})
    run = runtime.finish()
    place, expected = 0.0, []
    for commanded in [0.0, *run["X.Position"][:-1]]:
        place += 0.1 * (commanded - place)
        expected.append(place)
    assert run["X.ActualPosition"].tolist() == expected
    assert run.digest == standstill.run(move(), drives={"x": lagging(0.1)}).digest
    # The drive in the script follows exactly.
    assert run.digest != standstill.run(move()).digest


def test_a_drive_keeps_its_own_coordinates():
    blocks = [
        *move()["blocks"],
        {
            "name": "name",
            "type": "MC_SetPosition",
            "pins": {"Axis": "X", "Execute": {"from": "there.Done"}, "Position": 1000},
        },
    ]
    commands = []

    def drive(command):
        commands.append(command)
        return command.position

    script = move(blocks=blocks, expect=[{"by": 1190, "that": {"name.Done": True}}])
    run = standstill.run(script, drives={"X": drive})
    assert run.passed and run["X.Position"][-1] == 1000 and run["X.ActualPosition"][-1] == 1000
    assert run.digest == standstill.run(script).digest, "it does what the drive in the script does"
    places = [command.position for command in commands]
    assert max(places) == places[-1] == 40 and commands[0] == (0, "off", 0.0, 0.0)
    assert commands[-1].request == "enable"


def test_a_drive_counts_through_the_scaling_of_its_axis():
    axes = move()["axes"]
    axes["X"]["scaling"] = {"increments": 1000, "units": 1}
    run = standstill.run(move(axes=axes), drives={"X": lambda command: command.position + 0.0002})
    # A fifth of an increment is none.
    assert run.digest == standstill.run(move(axes=axes)).digest


def test_a_drive_far_away_trips_the_axis():
    axes = move()["axes"]
    axes["X"]["max_following_error"] = 1
    run = standstill.run(move(axes=axes), drives={"X": lambda command: 0.0})
    assert "ErrorStop" in run["X.State"] and not run.passed


def test_a_drive_that_raises_ends_the_run_and_its_rows_are_kept():
    def drive(command):
        if command.scan == 50:
            raise ZeroDivisionError("the model diverges")
        return command.position

    runtime = standstill.Runtime(move(), drives={"X": drive})
    with pytest.raises(ZeroDivisionError, match="the model diverges") as raised:
        while True:
            runtime.scan()
    trace = raised.value.trace
    assert len(trace) == len(runtime.trace) == 50
    assert trace["X.Position"].tolist() == standstill.run(move())["X.Position"][:50].tolist()
    assert "drive of X in scan 50" in raised.value.__notes__[0]
    assert runtime.is_over
    with pytest.raises(standstill.RunError, match="ended in scan 50.*diverges"):
        runtime.scan()
    with pytest.raises(ZeroDivisionError):
        standstill.run(move(), drives={"X": drive})


@pytest.mark.parametrize(
    ("place", "kind", "words"),
    [
        (float("nan"), ValueError, "X: the position is NaN"),
        (None, TypeError, "the position is None: one number is wanted"),
        (np.zeros(2), TypeError, "one number is wanted"),
        (KeyboardInterrupt("enough"), KeyboardInterrupt, "enough"),
    ],
)
def test_a_drive_that_is_nowhere_ends_the_run(place, kind, words):
    def drive(command):
        if command.scan < 5:
            return 0.0
        if isinstance(place, BaseException):
            raise place
        return place

    runtime = standstill.Runtime(move(), drives={"X": drive})
    with pytest.raises(kind, match=words) as raised:
        runtime.finish()
    assert len(raised.value.trace) == 5 and runtime.is_over


def test_a_drive_of_no_axis():
    with pytest.raises(KeyError, match="Y: there is no such axis; there are X"):
        standstill.Runtime(move(), drives={"Y": lagging(1)})
    with pytest.raises(TypeError, match="called with a Command"):
        standstill.Runtime(move(), drives={"X": 3})


def test_a_drive_cannot_scan_the_runtime_that_calls_it():
    runtime = standstill.Runtime(move(), drives={"X": lambda command: runtime.scan()})
    with pytest.raises(RuntimeError, match="is in scan 0 already"):
        runtime.scan()


def in_thread(call):
    """What a call in another thread returns or raises."""
    told = []

    def run():
        try:
            told.append(call())
        except BaseException as error:
            told.append(error)

    thread = threading.Thread(target=run, name="other")
    thread.start()
    thread.join()
    return told[0]


def test_two_threads_on_one_runtime():
    runtime = standstill.Runtime(move())
    assert runtime.scan()["GO"] is False
    error = in_thread(runtime.scan)
    assert isinstance(error, RuntimeError)
    assert "belongs to thread MainThread since its first scan, and thread other wants it" in str(error)
    assert runtime.scans == 1
    # Looking does no harm, and it can be handed over.
    assert in_thread(lambda: runtime["X.Position"]) == 0.0
    runtime.release()
    assert in_thread(runtime.scan)["GO"] is False
    # That thread has ended.
    assert runtime.scan()["GO"] is False and runtime.scans == 3


def test_many_threads_on_one_runtime_leave_it_whole():
    runtime = standstill.Runtime(move())
    wrong, done = [], []
    refused = threading.Event()

    def work():
        for _ in range(2000):
            try:
                runtime.scan()
                done.append(1)
            except standstill.RunError:
                return
            except RuntimeError:
                wrong.append(1)
                refused.set()
            # Whoever is first gives the others the time to be refused.
            assert len(done) != 1 or refused.wait(30)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(done) == runtime.scans == 1200 and wrong
    assert runtime.trace["X.Position"].tolist() == standstill.run(move())["X.Position"].tolist()


def test_faults_come_and_go():
    runtime = standstill.Runtime(move(steps=[]))
    runtime.scan()
    runtime.fault("X", "drive", code=7)
    assert runtime.scan()["X.State"] in ("Standstill", "ErrorStop")
    assert runtime.scan()["X.State"] == "ErrorStop"
    runtime.clear("X")
    runtime.scan()
    with pytest.raises(ValueError, match="there is no such fault"):
        runtime.fault("X", "mood")
    with pytest.raises(KeyError, match="there is no such axis"):
        runtime.fault("Y")


def test_what_was_done_by_hand_becomes_a_script():
    runtime = standstill.Runtime(move(steps=[]))
    for scan in range(1200):
        runtime.scan({"GO": True} if scan == 30 else {"level": scan / 3} if scan % 400 == 7 else {})
    text = runtime.as_script()
    run = runtime.finish()
    assert run.passed and standstill.run_text(text)["X.Position"].tolist() == run["X.Position"].tolist()
    assert standstill.run_text(text)["level"].tolist() == run["level"].tolist()


def test_variables_of_a_program_are_inputs():
    runtime = standstill.Runtime(SCRIPTS / "gallery" / "packer.scan.json")
    assert runtime.inputs and runtime.scan()
