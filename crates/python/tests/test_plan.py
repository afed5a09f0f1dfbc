"""`plan`: the answers of the command line, as dicts."""

import json
import math
import re

import numpy as np
import pytest
from conftest import ROOT, installed

import standstill

REFUSED = [
    {"Ts": 0.001, "target": 1, "limits": {"velocity": 0, "acceleration": 20}},
    {"Ts": 0.001, "target": 1, "limits": {"velocity": 1, "acceleration": 20}, "speed": 3},
    {"target": 1, "limits": {"velocity": 1, "acceleration": 20}},
    {"Ts": 0.001, "target": 1, "limits": {"velocity": 1, "acceleration": 20}, "method": "onlin"},
    {"Ts": 0.001, "target": 1, "limits": {"velocity": 1, "acceleration": 20}, "method": 3},
    {"Ts": 0.001, "target": 1, "limits": {"velocity": 1, "acceleration": 20}, "velocity": 1, "method": "grid"},
    {"Ts": 0.001, "target": 1, "limits": {"velocity": 1, "acceleration": 20}, "end_velocity": -3, "method": "online"},
    {"Ts": 0.001, "target": 1, "limits": {"velocity": 1, "acceleration": True}},
    {"Ts": 0.001, "target": 1e300, "limits": {"velocity": 1e-300, "acceleration": 20}},
    {"Ts": 0.001, "target": 1, "limits": 5},
    {"Ts": 0.001, "target": 1, "limits": {}},
    {"Ts": None, "target": 1, "limits": {"velocity": 1}},
    {"Ts": {"a": 1}, "target": 1, "limits": {"velocity": 1}},
    {},
]


def lines():
    """The lines in the guides, and those that are refused."""
    found = []
    for page in sorted((ROOT / "docs").glob("*.md")):
        for block in re.findall(r"```jsonl\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
            found += [json.loads(line) for line in block.splitlines() if line.strip()]
    found = [line for line in found if isinstance(line, dict) and ("target" in line or "targets" in line)]
    assert len(found) > 20
    return found + REFUSED


def test_answers_and_refusals_are_those_of_the_command_line():
    told = installed("plan", input="\n".join(map(json.dumps, lines()))).stdout.splitlines()
    planned = 0
    for line, answer in zip(lines(), map(json.loads, told), strict=True):
        if "error" not in answer:
            found = standstill.plan(**line)
            assert found == answer
            # In the same order, and -0.0 nowhere.
            assert json.dumps(found) == json.dumps(answer)
            planned += 1
            continue
        with pytest.raises(standstill.PlanError) as refused:
            standstill.plan(**line)
        error, expected = refused.value, answer["error"]
        assert (error.code, error.field, error.message) == (expected["code"], expected["field"], expected["message"])
        assert (error.value, error.nearest) == (expected["value"], expected.get("nearest"))
    assert planned > 20


def test_a_refusal_says_what_and_where():
    with pytest.raises(standstill.PlanError) as refused:
        standstill.plan(Ts=0.001, target=1, limits={"velocity": 1, "acceleration": 2, "jerk": math.nan})
    error = refused.value
    assert (error.code, error.field) == ("invalid_input", "limits.jerk") and math.isnan(error.value)
    assert isinstance(error, ValueError) and "must be finite" in str(error)


def test_numbers_of_numpy_are_numbers_and_arrays_are_none():
    limits = {"velocity": np.float32(2), "acceleration": np.int64(20)}
    assert standstill.plan(Ts=np.float64(0.001), target=np.int32(1), limits=limits, id=[1, "a"]) == standstill.plan(
        Ts=0.001, target=1, limits={"velocity": 2, "acceleration": 20}, id=[1, "a"]
    )
    for value, field in ((np.zeros(3), "target"), ("1", "target"), ([1.0], "target")):
        with pytest.raises(standstill.PlanError, match="`target` must be a number") as refused:
            standstill.plan(Ts=0.001, target=value, limits=limits)
        assert refused.value.field == field and refused.value.value is value
    tracked = standstill.plan(Ts=0.001, method="tracking", targets=np.array([[0.0, 1.0], [0.1, 2.0]]), limits=limits)
    assert tracked["end"]["position"] == 2
    with pytest.raises(TypeError, match="has no form in JSON"):
        standstill.plan(Ts=0.001, target=object(), limits=limits)
