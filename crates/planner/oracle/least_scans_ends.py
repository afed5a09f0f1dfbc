#!/usr/bin/env python3
"""The least number of scans to a position with an end velocity and an end acceleration, by linear programming.

    least_scans_ends.py make SEED COUNT        makes and solves COUNT cases; none is left out after it was solved
    least_scans_ends.py check FILE ...         solves committed cases again and fails if one differs
    least_scans_ends.py lines FILE ...         the cases as lines for `standstill compare-planners`

A case is {"order", "Ts", "Vp", "Vn", "A", "J", "S", "x0", "v0", "a0", "j0", "target", "ve", "ae"} in SI units; order
3 has no S and no j0, order 2 no J and no a0 either. A move of N scans is N values of the highest derivative, each held
for one scan and integrated exactly. It ends on `target` with the velocity `ve`, the acceleration `ae` and no jerk (as
far as its order has them), and keeps |snap| <= S throughout and, at every scan between start and end, |jerk| <= J,
|acceleration| <= A and -Vn <= velocity <= Vp. The least N for which that is a linear programme with a solution is
`n_star`. N is tried in ascending order, because from a moving start a feasible N says nothing about N + 1. A planner
that switches between scans may need fewer; none that switches at scans does.

A start is a state in the middle of a move of the same kind under 85 % of the bounds; an end is drawn so that bringing
its acceleration to zero, forwards in time and backwards, stays inside 90 % of the bounds. A fifth of the cases have
an end velocity that points away from the target, a target on the start, or an end as fast as the bounds allow.

Needs NumPy and SciPy (its HiGHS solver). Made with NumPy 2 and SciPy 1.17. It shares no code with the planner.
"""

import json
import random
import sys

import numpy as np
from scipy.optimize import linprog

MISS = 1e-7
MOST = 150
NAMES = ("x", "v", "a", "j")
HIGHEST = {2: "A", 3: "J", 4: "S"}


class Programme:
    """The linear programmes of one case, in units of scans and of what one scan of the highest derivative changes."""

    def __init__(self, case):
        order, ts = case["order"], case["Ts"]
        self.order = order
        top = case[HIGHEST[order]]
        self.unit = np.array([top * ts ** (order - n) for n in range(order)])
        self.start = np.array([case.get(name + "0", 0.0) for name in NAMES[:order]]) / self.unit
        self.start[0] = 0.0
        end = [case["target"] - case["x0"], case.get("ve", 0.0), case.get("ae", 0.0), 0.0][:order]
        self.end = np.array(end) / self.unit
        bound = [case["A"], case.get("J")][: order - 2]
        self.high = np.array([case["Vp"], *bound]) / self.unit[1:]
        self.low = -np.array([case["Vn"], *bound]) / self.unit[1:]
        # What a held input, and each state, becomes within a scan: t^n/n!.
        factorial = [1, 1, 2, 6, 24]
        self.step = np.array([[1 / factorial[c - r] if c >= r else 0.0 for c in range(order)] for r in range(order)])
        self.held = np.array([1 / factorial[order - r] for r in range(order)])

    def solve(self, count):
        """(miss relative to the way, inputs) of the best move of `count` scans; None if none ends as asked."""
        n = self.order
        free, forced = [self.start], [self.held]
        for _ in range(count):
            free.append(self.step @ free[-1])
            forced.append(self.step @ forced[-1])
        free, forced = np.array(free), np.array(forced)
        gains = np.zeros((count, n, count))
        for k in range(count):
            gains[k, :, : k + 1] = forced[: k + 1][::-1].T
        last = gains[-1]
        inner = gains[:-1, 1:, :].reshape(-1, count)
        high, low = np.tile(self.high, count - 1)[:, None], np.tile(self.low, count - 1)[:, None]
        scale = np.maximum(high, -low)
        drift = free[1:count, 1:].reshape(-1, 1)
        rows = np.vstack([inner / scale, -inner / scale])
        right = np.concatenate([((high - drift) / scale).ravel(), ((drift - low) / scale).ravel()])
        rows = np.hstack([rows, np.zeros((len(rows), 1))])
        # The miss is one more variable, in units of the way that could be gone.
        away = self.end[0] - free[count, 0]
        way = max(abs(self.end[0]), abs(away), np.abs(last[0]).sum() * 1e-3, 1e-9)
        rows = np.vstack([rows, np.append(last[0] / way, -1), np.append(-last[0] / way, -1)])
        right = np.append(right, [away / way, -away / way])
        sizes = np.maximum(self.high, -self.low)
        equal = np.hstack([last[1:] / sizes[:, None], np.zeros((n - 1, 1))])
        at_end = (self.end[1:] - free[count, 1:]) / sizes
        cost = np.zeros(count + 1)
        cost[-1] = 1
        bounds = [(-1, 1)] * count + [(0, None)]
        result = linprog(cost, A_ub=rows, b_ub=right, A_eq=equal, b_eq=at_end, bounds=bounds, method="highs")
        return (result.x[-1], result.x[:-1]) if result.status == 0 else None


def least(case, most=MOST):
    programme = Programme(case)
    slowest = abs(programme.end[0]) / max(programme.high[0], -programme.low[0])
    for count in range(max(1, int(slowest * (1 - 1e-9))), most + 1):
        found = programme.solve(count)
        if found and found[0] <= MISS:
            return count
    return None


def states(case, count):
    """The states of the best move of `count` scans, as SI values; None if there is none."""
    programme = Programme(case)
    found = programme.solve(count)
    if found is None:
        return None
    path = [programme.start]
    for value in found[1]:
        path.append(programme.step @ path[-1] + programme.held * value)
    return np.array(path) * programme.unit


def settles(case, v, a, j, part):
    """Whether bringing acceleration and jerk to zero as fast as can be keeps `part` of the bounds, between scans too."""
    if case["order"] == 2:
        return -part * case["Vn"] <= v <= part * case["Vp"]
    top, bound = case[HIGHEST[case["order"]]], case.get("J", np.inf)
    if case["order"] == 3:
        spans = [(abs(a) / top, -top if a > 0 else top)]
    else:
        coming = a + j * abs(j) / (2 * top)
        side = -1 if coming > 0 else 1
        peak = min(bound, max(0.0, top * -side * a + j * j / 2) ** 0.5)
        hold = max(0.0, (-side * a - (peak**2 - j * j / 2) / top) / peak) if peak else 0.0
        spans = [(max(0.0, (peak - side * j) / top), side * top), (hold, 0.0), (peak / top, -side * top)]
    values = [(v, a)]
    for time, value in spans:
        for _ in range(50):
            h = time / 50
            if case["order"] == 3:
                v, a = v + h * (a + h * value / 2), a + h * value
            else:
                v, a, j = v + h * (a + h * (j / 2 + h * value / 6)), a + h * (j + h * value / 2), j + h * value
            values.append((v, a))
    return all(-part * case["Vn"] <= v <= part * case["Vp"] and abs(a) <= part * case["A"] for v, a in values)


def draw(rng):
    """Bounds that each take some scans to reach, a start in the middle of another move, and an end."""
    order = rng.choice([2, 3, 3, 4, 4, 4])
    ts = rng.choice([0.0005, 0.001, 0.002, 0.005])
    top = 10 ** rng.uniform(1, 6)
    case, value = {"order": order, "Ts": ts}, top
    for name in {2: "A", 3: "JA", 4: "SJA"}[order]:
        case[name] = value
        value *= ts * 10 ** rng.uniform(0.2, 1.1)
    fast, slow = value, value * (1 if rng.random() < 0.4 else 10 ** rng.uniform(-1, 0))
    case["Vp"], case["Vn"] = (fast, slow) if rng.random() < 0.5 else (slow, fast)
    case |= {name + "0": 0.0 for name in NAMES[:order]}
    way = fast * ts * rng.uniform(5, 50)
    kind = rng.random()
    if rng.random() < 0.85:
        other = {**case, **{key: 0.85 * case[key] for key in ("Vp", "Vn", "A", "J", "S") if key in case}}
        other["target"] = way * rng.choice([-1, 1])
        count = least(other)
        if count is None:
            return None
        path = states(other, count + rng.choice([0, 0, 3, 8]))
        if path is None or len(path) < 3:
            return None
        state = path[rng.randrange(1, len(path) - 1)]
        case |= {name + "0": float(value) for name, value in zip(NAMES, state)}
        if not settles(case, case["v0"], case.get("a0", 0.0), case.get("j0", 0.0), 1.0):
            return None
    way *= rng.uniform(-1, 1)
    for _ in range(100):
        ve = rng.uniform(-case["Vn"], case["Vp"])
        ae = 0.0 if order == 2 or rng.random() < 0.25 else case["A"] * rng.uniform(-0.9, 0.9)
        if kind < 0.1:
            ve = -abs(ve) * np.sign(way)
        elif kind < 0.15:
            way = 0.0
        elif kind < 0.2:
            ve, ae = (case["Vp"] if rng.random() < 0.5 else -case["Vn"]), 0.0
        part = 1.0 if ae == 0 else 0.9
        if settles(case, ve, ae, 0.0, part) and settles(case, ve, -ae, 0.0, part):
            break
    else:
        return None
    case |= {"target": case["x0"] + way, "ve": float(ve), "ae": ae}
    return case


def line(case):
    """A case as `standstill compare-planners` takes it."""
    names = {"A": "acceleration", "J": "jerk", "S": "snap"}
    start = {"position": "x0", "velocity": "v0", "acceleration": "a0", "jerk": "j0"}
    return {
        "Ts": case["Ts"],
        **{key: case[of] for key, of in start.items() if case.get(of, 0) != 0},
        "target": case["target"],
        "end_velocity": case["ve"],
        "end_acceleration": case["ae"],
        "limits": {"velocity": max(case["Vp"], case["Vn"]), **{names[key]: case[key] for key in names if key in case}},
        "velocity_limits": {"positive": case["Vp"], "negative": case["Vn"]},
        "method": "online",
    }


def read(files):
    for name in files:
        with open(name) as file:
            yield name, json.load(file)


def check(files):
    differ = 0
    for name, cases in read(files):
        wrong = [(case, count) for case in cases if (count := least(case, 10 * MOST)) != case["n_star"]]
        print(f"{name}: {len(cases)} cases, {len(wrong)} differ")
        for case, count in wrong:
            print(f"  {json.dumps(case)} needs {count}")
        differ += len(wrong)
    sys.exit(1 if differ else 0)


def make(seed, count):
    rng = random.Random(seed)
    cases = []
    while len(cases) < count:
        case = draw(rng)
        if case is not None and (found := least(case)) is not None:
            cases.append({**case, "n_star": found})
            print(len(cases), case["order"], found, file=sys.stderr)
    print("[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]")


def main():
    if sys.argv[1:2] == ["check"] and len(sys.argv) > 2:
        check(sys.argv[2:])
    elif sys.argv[1:2] == ["lines"] and len(sys.argv) > 2:
        for name, cases in read(sys.argv[2:]):
            for index, case in enumerate(cases):
                print(json.dumps({"id": index, "n_star": case["n_star"], **line(case)}))
    elif sys.argv[1:2] == ["make"] and len(sys.argv) == 4:
        make(int(sys.argv[2]), int(sys.argv[3]))
    else:
        sys.exit(__doc__)


main()
