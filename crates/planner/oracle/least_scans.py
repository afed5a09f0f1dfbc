#!/usr/bin/env python3
"""The least number of scans a snap-limited move can take on a sample grid, by linear programming.

    least_scans.py solve < cases.json          adds "n_star" to every case, or checks the one it has
    least_scans.py random SEED COUNT           makes and solves COUNT cases; none is left out afterwards
    least_scans.py passing SEED COUNT          the same with an end velocity ("ve") other than 0

A case is {"chain", "Ts", "V", "A", "J", "S", "x0", "v0", "a0", "j0", "target"} in SI units. A move of N scans
is N snaps, each held for one scan. It ends on `target` with the velocity `ve` (0 if absent) and without
acceleration and jerk, and keeps |snap| <= S throughout and |jerk| <= J, |acceleration| <= A, |velocity| <= V at
every scan after the start. Chain "exact" integrates the held snap exactly; chain "euler" lets each
integrator add what its input was a scan before.

For one N this is a linear programme in the snaps; its optimum is the least distance by which the target is
missed. The least N with a miss of rounding size is `n_star`. N is tried in ascending order, because from a
moving start a feasible N says nothing about N + 1. No planner that holds the snap for whole scans can do with
fewer; one that switches between scans may.

Needs NumPy and SciPy (its HiGHS solver). Used with NumPy 2 and SciPy 1.16.
"""

import json
import random
import sys

import numpy as np
from scipy.optimize import linprog

MISS = 1e-7
MOST = 170


class Programme:
    """The linear programmes of one case, in units of scans and of what one scan of full snap changes."""

    def __init__(self, case):
        ts, snap = case["Ts"], case["S"]
        unit = np.array([snap * ts**4, snap * ts**3, snap * ts**2, snap * ts])
        self.start = np.array([0.0, case["v0"], case["a0"], case["j0"]]) / unit
        self.bound = np.array([case["V"], case["A"], case["J"]]) / unit[1:]
        self.target = (case["target"] - case["x0"]) / unit[0]
        self.end = np.array([case.get("ve", 0.0) / unit[1], 0.0, 0.0])
        if case["chain"] == "euler":
            self.step = np.eye(4) + np.eye(4, k=1)
            self.snap = np.array([0.0, 0.0, 0.0, 1.0])
        else:
            self.step = np.array([[1, 1, 1 / 2, 1 / 6], [0, 1, 1, 1 / 2], [0, 0, 1, 1], [0, 0, 0, 1.0]])
            self.snap = np.array([1 / 24, 1 / 6, 1 / 2, 1.0])

    def responses(self, count):
        """free[k]: the state after k scans without snap; forced[m]: what a snap has done m + 1 scans on."""
        free, forced = [self.start], [self.snap]
        for _ in range(count):
            free.append(self.step @ free[-1])
            forced.append(self.step @ forced[-1])
        return np.array(free), np.array(forced)

    def solve(self, count):
        """(miss relative to the way, snaps) of the best move of `count` scans; None if none ends as asked."""
        free, forced = self.responses(count)
        gains = np.zeros((count, 4, count))
        for k in range(count):
            gains[k, :, : k + 1] = forced[: k + 1][::-1].T
        # The miss is one more variable, in units of the way that could be gone.
        last = gains[-1]
        way = max(abs(self.target), abs(free[count, 0] - self.target), np.abs(last[0]).sum() * 1e-3, 1e-9)
        inner = gains[:-1, 1:, :].reshape(-1, count)
        scale = np.tile(self.bound, count - 1)[:, None] if count > 1 else np.ones((0, 1))
        drift = free[1:count, 1:].reshape(-1, 1)
        rows = np.vstack([inner / scale, -inner / scale, last[:1] / way, -last[:1] / way])
        rows = np.hstack([rows, np.zeros((len(rows), 1))])
        rows[-2:, -1] = -1
        off = (free[count, 0] - self.target) / way
        right = np.concatenate([(1 - drift / scale).ravel(), (1 + drift / scale).ravel(), [-off, off]])
        equal = np.hstack([last[1:] / self.bound[:, None], np.zeros((3, 1))])
        at_end = (self.end - free[count, 1:]) / self.bound
        cost = np.zeros(count + 1)
        cost[-1] = 1
        limits = [(-1, 1)] * count + [(0, None)]
        result = linprog(cost, A_ub=rows, b_ub=right, A_eq=equal, b_eq=at_end, bounds=limits, method="highs")
        return (result.x[-1], result.x[:-1]) if result.status == 0 else None


def least(case, most=MOST):
    programme = Programme(case)
    slowest = abs(programme.target) / programme.bound[0]
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
    ts, snap = case["Ts"], case["S"]
    unit = np.array([snap * ts**4, snap * ts**3, snap * ts**2, snap * ts])
    path = [programme.start]
    for value in found[1]:
        path.append(programme.step @ path[-1] + programme.snap * value)
    return np.array(path) * unit


def is_viable(case):
    """Whether acceleration and jerk can be brought to zero inside the bounds, between the scans too."""
    V, A, J, S = (case[key] for key in "VAJS")
    v, a, j = case["v0"], case["a0"], case["j0"]
    coming = a + j * abs(j) / (2 * S)
    # Towards zero from where the jerk itself can be ended; the jerk falls, is held at its bound, and rises.
    side = -1 if coming > 0 else 1
    lowest = min(J, max(0.0, S * -side * a + j * j / 2) ** 0.5)
    fall, rise = max(0.0, (lowest - side * j) / S), lowest / S
    hold = max(0.0, (-side * a - (lowest**2 - j * j / 2) / S) / lowest) if lowest else 0.0
    values = [(v, a)]
    for time, snap in ((fall, side * S), (hold, 0.0), (rise, -side * S)):
        for _ in range(50):
            h = time / 50
            v += h * (a + h * (j / 2 + h * snap / 6))
            a += h * (j + h * snap / 2)
            j += h * snap
            values.append((v, a))
    return all(abs(v) <= V and abs(a) <= A for v, a in values)


def draw(rng, passing):
    """Bounds that each take some scans to reach, a start at rest or in the middle of another move.

    The other move keeps 85 % of the bounds, because at the scans alone is not between them.
    """
    ts = rng.choice([0.0005, 0.001, 0.002, 0.005])
    snap = 10 ** rng.uniform(1, 7)
    jerk = snap * ts * 10 ** rng.uniform(0, 1)
    acceleration = jerk * ts * 10 ** rng.uniform(0, 1.2)
    velocity = acceleration * ts * 10 ** rng.uniform(0, 1.4)
    still = {"x0": 0.0, "v0": 0.0, "a0": 0.0, "j0": 0.0}
    case = {"chain": "exact", "Ts": ts, "V": velocity, "A": acceleration, "J": jerk, "S": snap, **still}
    way = velocity * ts * rng.uniform(5, 60)
    if not passing and rng.random() < 0.25:
        return {**case, "chain": "euler", "target": way * rng.choice([-1, 1]) * rng.uniform(0.01, 1)}
    other = {**case, **{key: 0.85 * case[key] for key in "VAJS"}, "target": way * rng.choice([-1, 1])}
    count = least(other)
    if count is None:
        return None
    # A few scans more than the least leave the move room to be none of the fastest.
    path = states(other, count + rng.choice([0, 0, 3, 10]))
    if path is None:
        return None
    x, v, a, j = (float(value) for value in path[rng.randrange(1, len(path) - 1)])
    case |= {"x0": x, "v0": v, "a0": a, "j0": j, "target": x + way * rng.uniform(-1, 1)}
    if passing:
        case["ve"] = velocity * rng.uniform(-1, 1)
    return case if is_viable(case) else None


def main():
    if sys.argv[1:] == ["solve"]:
        cases = json.load(sys.stdin)
        for case in cases:
            found = least(case, 10 * MOST)
            if case.setdefault("n_star", found) != found:
                print(f"{case} needs {found}", file=sys.stderr)
    elif sys.argv[1:2] in (["random"], ["passing"]) and len(sys.argv) == 4:
        rng = random.Random(int(sys.argv[2]))
        cases = []
        while len(cases) < int(sys.argv[3]):
            case = draw(rng, sys.argv[1] == "passing")
            if case is not None and (found := least(case)) is not None:
                cases.append({**case, "n_star": found})
    else:
        sys.exit(__doc__)
    print("[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]")


main()
