"""The pytest plug-in: scripts are tests, judged as `standstill test` does."""

import json

import pytest
from conftest import installed, move


def scripts(folder):
    (folder / "good.scan.json").write_text(json.dumps(move(golden=False)))
    late = move(golden=False, parameters={"v": 1})
    (folder / "late.scan.json").write_text(json.dumps(late))
    (folder / "broken.scan.json").write_text(json.dumps(move()).replace('"Execute"', '"Exceute"'))
    # A claim alone is no golden.
    (folder / "bare.scan.json").write_text(json.dumps(move()))


def test_scripts_are_collected_judged_and_explained(pytester):
    folder = pytester.mkdir("cell")
    scripts(folder)
    before = sorted(folder.iterdir())
    # Where nothing says CI a golden may be proposed; the plug-in does not even then.
    for name in ("CI", "INSTA_UPDATE"):
        pytester._monkeypatch.delenv(name, raising=False)
    result = pytester.runpytest_subprocess("-rA")
    result.assert_outcomes(passed=1, failed=3)
    assert sorted(folder.iterdir()) == before
    shown = result.stdout.str()
    told = installed("test", "--golden", "exact", str(folder), env={"INSTA_UPDATE": "no"})
    for line in told.stdout.splitlines():
        if line.startswith("    "):
            assert line.strip() in shown, line
    assert "unknown_pin" in shown and "broken.scan.json:" in shown
    assert "Traceback" not in shown and "pytest_plugin.py" not in shown


def test_goldens_count(pytester):
    folder = pytester.mkdir("cell")
    script = folder / "there.scan.json"
    script.write_text(json.dumps(move()))
    assert installed("test", "--accept", str(folder), env={}).returncode == 0
    pytester.runpytest_subprocess().assert_outcomes(passed=1)
    # Another motion with claims that hold.
    script.write_text(json.dumps(move(parameters={"v": 49})))
    result = pytester.runpytest_subprocess()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*golden: *"])


def test_they_are_chosen_as_all_tests_are(pytester):
    folder = pytester.mkdir("cell")
    scripts(folder)
    pytester.makepyfile(test_own="def test_mine(): pass")
    pytester.runpytest_subprocess("-k", "good or mine").assert_outcomes(passed=2, deselected=3)
    pytester.runpytest_subprocess("cell/good.scan.json").assert_outcomes(passed=1)
    listed = pytester.runpytest_subprocess("--collect-only", "-q").stdout.str()
    assert "cell/good.scan.json::good" in listed


def test_files_from_another_folder_are_asked_for(pytester):
    cell, machines = pytester.mkdir("cell"), pytester.mkdir("machines")
    axes = move()["axes"]
    (machines / "one.machine.json").write_text(json.dumps({"standstill": 1, "axes": axes}))
    script = move(golden=False, axes={}, include="../machines/one.machine.json")
    (cell / "good.scan.json").write_text(json.dumps(script))
    result = pytester.runpytest_subprocess()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*bad_include*"])
    pytester.makeini("[pytest]\nstandstill_include_from = machines\n")
    pytester.runpytest_subprocess().assert_outcomes(passed=1)


@pytest.mark.parametrize("name", ["good.json", "good.machine.json"])
def test_other_files_are_left_alone(pytester, name):
    (pytester.path / name).write_text("{}")
    pytester.runpytest_subprocess().assert_outcomes()
