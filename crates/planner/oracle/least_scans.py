#!/usr/bin/env python3
"""The least number of scans a snap-limited move can take on a sample grid, by linear programming.

    least_scans.py solve < cases.json          adds "n_star" to every case, or checks the one it has
    least_scans.py check FILE ...              solves committed cases again and fails if one differs
    least_scans.py lines FILE ...              the cases as lines for `standstill compare-planners`
    least_scans.py random SEED COUNT           makes and solves COUNT cases; none is left out afterwards
    least_scans.py passing SEED COUNT          the same with an end velocity ("ve") other than 0
    least_scans.py lowered SEED COUNT          the same under limits lowered in flight
    least_scans.py ramps SEED COUNT            the same to a velocity ("ve"), wherever that is
    least_scans.py stops SEED COUNT            the same to rest, wherever that is

A case is {"chain", "Ts", "V", "A", "J", "S", "x0", "v0", "a0", "j0", "target"} in SI units. A move of N scans
is N snaps, each held for one scan. It ends on `target`, if there is one, with the velocity `ve` (0 if absent) and
without acceleration and jerk, and keeps |snap| <= S throughout and |jerk| <= J, |acceleration| <= A, |velocity| <= V
at every scan after the start. Chain "exact" integrates the held snap exactly; chain "euler" lets each
integrator add what its input was a scan before.

For one N this is a linear programme in the snaps; its optimum is the least distance by which the target is
missed. The least N with a miss of rounding size is `n_star`. N is tried in ascending order, because from a
moving start a feasible N says nothing about N + 1. No planner that holds the snap for whole scans can do with
fewer; one that switches between scans may.

With "before", the limits kept so far, the larger ones hold for the first `outside` scans. `outside` is the least
number after which the limits can be kept to the end of some move to rest: getting inside them comes first, and only
then do scans count.

Needs NumPy and SciPy (its HiGHS solver). Used with NumPy 2 and SciPy 1.16 and 1.17.
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
        self.unit = np.array([snap * ts**4, snap * ts**3, snap * ts**2, snap * ts])
        self.start = np.array([0.0, case["v0"], case["a0"], case["j0"]]) / self.unit
        self.bound = np.array([case["V"], case["A"], case["J"]]) / self.unit[1:]
        before = case.get("before", case)
        self.wider = np.maximum(self.bound, np.array([before["V"], before["A"], before["J"]]) / self.unit[1:])
        self.wider_snap = max(1.0, before["S"] / snap)
        self.target = (case["target"] - case["x0"]) / self.unit[0] if "target" in case else None
        self.end = np.array([case.get("ve", 0.0) / self.unit[1], 0.0, 0.0])
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

    def solve(self, count, outside=0):
        """(miss relative to the way, snaps) of the best move of `count` scans; None if none ends as asked.

        The wider limits hold in the first `outside` scans.
        """
        free, forced = self.responses(count)
        gains = np.zeros((count, 4, count))
        for k in range(count):
            gains[k, :, : k + 1] = forced[: k + 1][::-1].T
        last = gains[-1]
        inner = gains[:-1, 1:, :].reshape(-1, count)
        scale = np.tile(self.bound, count - 1)
        scale[: 3 * max(0, outside - 1)] = np.tile(self.wider, max(0, outside - 1))
        scale, drift = scale[:, None], free[1:count, 1:].reshape(-1, 1)
        rows = np.vstack([inner / scale, -inner / scale])
        right = np.concatenate([(1 - drift / scale).ravel(), (1 + drift / scale).ravel()])
        rows = np.hstack([rows, np.zeros((len(rows), 1))])
        if self.target is not None:
            # The miss is one more variable, in units of the way that could be gone.
            ways = (self.target, free[count, 0] - self.target, np.abs(last[0]).sum() * 1e-3, 1e-9)
            way = max(abs(value) for value in ways)
            off = (free[count, 0] - self.target) / way
            miss = np.append(last[0] / way, -1), np.append(-last[0] / way, -1)
            rows, right = np.vstack([rows, *miss]), np.append(right, [-off, off])
        equal = np.hstack([last[1:] / self.bound[:, None], np.zeros((3, 1))])
        at_end = (self.end - free[count, 1:]) / self.bound
        cost = np.zeros(count + 1)
        cost[-1] = 1
        snaps = [(-self.wider_snap, self.wider_snap)] * min(outside, count) + [(-1, 1)] * max(0, count - outside)
        bounds = snaps + [(0, None)]
        result = linprog(cost, A_ub=rows, b_ub=right, A_eq=equal, b_eq=at_end, bounds=bounds, method="highs")
        return (result.x[-1], result.x[:-1]) if result.status == 0 else None


def scans_outside(case):
    """The least number of scans after which the limits can be kept until rest; more are then enough, too."""
    to_rest = {key: value for key, value in case.items() if key not in ("target", "ve")}
    programme = Programme(to_rest)
    enough = 4 * case["J"] / case["S"] + 2 * case["A"] / case["J"] + case["V"] / case["A"]
    enough = int(enough / case["Ts"]) + 4

    def is_enough(outside):
        return programme.solve(outside + enough, outside) is not None

    high = 0
    while not is_enough(high):
        high = max(1, 2 * high)
        if high > MOST:
            return None
    low = high // 2
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if is_enough(middle) else (middle, high)
    return high


def least(case, most=MOST):
    programme = Programme(case)
    outside = scans_outside(case) if "before" in case else 0
    if outside is None:
        return None
    slowest = abs(programme.target or 0.0) / max(programme.bound[0], programme.wider[0])
    for count in range(max(1, outside, int(slowest * (1 - 1e-9))), most + 1):
        found = programme.solve(count, outside)
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
        path.append(programme.step @ path[-1] + programme.snap * value)
    return np.array(path) * programme.unit


def is_viable(case, lowest=None):
    """Whether acceleration and jerk can be brought to zero inside the bounds, between the scans too.

    The velocity has to stay above `lowest`, if that is said, and not only above -V.
    """
    V, A, J, S = (case[key] for key in "VAJS")
    v, a, j = case["v0"], case["a0"], case["j0"]
    coming = a + j * abs(j) / (2 * S)
    # Towards zero from where the jerk itself can be ended; the jerk falls, is held at its bound, and rises.
    side = -1 if coming > 0 else 1
    peak = min(J, max(0.0, S * -side * a + j * j / 2) ** 0.5)
    fall, rise = max(0.0, (peak - side * j) / S), peak / S
    hold = max(0.0, (-side * a - (peak**2 - j * j / 2) / S) / peak) if peak else 0.0
    values = [(v, a)]
    for time, snap in ((fall, side * S), (hold, 0.0), (rise, -side * S)):
        for _ in range(50):
            h = time / 50
            v += h * (a + h * (j / 2 + h * snap / 6))
            a += h * (j + h * snap / 2)
            j += h * snap
            values.append((v, a))
    lowest = -V if lowest is None else lowest
    return all(lowest <= v <= V and abs(a) <= A for v, a in values)


def draw(rng, kind):
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
    if kind == "random" and rng.random() < 0.25:
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
    if kind in ("passing", "ramps"):
        case["ve"] = velocity * rng.uniform(-1, 1)
    if not is_viable(case):
        return None
    if kind == "lowered":
        case["before"] = {key: case[key] for key in "VAJS"}
        case |= {key: case[key] * rng.uniform(0.4, 1) for key in "VAJS"}
    if kind in ("ramps", "stops"):
        del case["target"]
        # A ramp that keeps its direction must not turn back if it can help it, which a programme does not know.
        side = 1 if v > 0 else -1
        if not is_viable({**case, **{key: side * case[key] for key in ("v0", "a0", "j0")}}, 0.0):
            return None
    return case


def line(case):
    """A case as `standstill` takes it."""
    names = {"V": "velocity", "A": "acceleration", "J": "jerk", "S": "snap"}
    limits = {"limits": case} | ({"limits_before": case["before"]} if "before" in case else {})
    start = {"position": "x0", "velocity": "v0", "acceleration": "a0", "jerk": "j0"}
    return {
        "Ts": case["Ts"],
        **{key: case[of] for key, of in start.items() if case[of] != 0},
        **({"target": case["target"]} if "target" in case else {}),
        **({"end_velocity": case["ve"]} if "ve" in case else {}),
        **{key: {name: of[letter] for letter, name in names.items()} for key, of in limits.items()},
        "n_star": case["n_star"],
    }


def read(files):
    for name in files:
        with open(name) as file:
            yield name, json.load(file)


def check(files):
    differ = 0
    for name, cases in read(files):
        found = [(case, least(case, 10 * MOST)) for case in cases]
        wrong = [(case, count) for case, count in found if count != case["n_star"]]
        print(f"{name}: {len(cases)} cases, {len(wrong)} differ")
        for case, count in wrong:
            print(f"  {json.dumps(case)} needs {count}")
        differ += len(wrong)
    sys.exit(1 if differ else 0)


def main():
    if sys.argv[1:2] == ["check"] and len(sys.argv) > 2:
        check(sys.argv[2:])
    elif sys.argv[1:2] == ["lines"] and len(sys.argv) > 2:
        for name, cases in read(sys.argv[2:]):
            for index, case in enumerate(cases):
                print(json.dumps({"id": f"{name.rsplit('/', 1)[-1].removesuffix('.json')} {index}", **line(case)}))
        return
    elif sys.argv[1:] == ["solve"]:
        cases = json.load(sys.stdin)
        for case in cases:
            found = least(case, 10 * MOST)
            if case.setdefault("n_star", found) != found:
                print(f"{case} needs {found}", file=sys.stderr)
    elif sys.argv[1:2] in (["random"], ["passing"], ["lowered"], ["ramps"], ["stops"]) and len(sys.argv) == 4:
        rng = random.Random(int(sys.argv[2]))
        cases = []
        while len(cases) < int(sys.argv[3]):
            case = draw(rng, sys.argv[1])
            if case is not None and (found := least(case)) is not None:
                cases.append({**case, "n_star": found})
    else:
        sys.exit(__doc__)
    print("[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]")


main()
