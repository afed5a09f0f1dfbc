"""Least numbers of scans until a slave is on the law of its gear, by linear programming: makes lock_times.json.

    python3 lock_times.py draw SEED > cases.json
    STANDSTILL_CASES=$PWD/cases.json cargo test -p standstill-tests --test axis runs_for -- --ignored
    python3 lock_times.py solve cases.json > lock_times.json      (needs SciPy)

The run in the middle tells where the slave starts and where the master is in each scan; nothing of how the slave moves
enters the solution. A programme of N scans holds any snap within its bound for a whole scan (a jerk, on an axis without a
snap limit), is integrated exactly, has velocity, acceleration and jerk within their bounds at every scan, the velocity also
within the pin Velocity and not against the direction of the law, and ends in scan N with the law's velocity, acceleration and
jerk, with MC_GearInPos at its place, too. `least` is the smallest N with a solution. Once on the law it can stay there, so
what has a solution for N has one for more.

`ahead` is how far the slave is ahead of the law at the start (u), `.._lead` how many scans before it an axis was given its
velocity, `master_halt` the same for MC_Halt of the master (0: none), `velocity` the pin (0: the axis limit). Limits are
velocity, acceleration, jerk and snap.
"""

import json
import random
import sys

import numpy as np
from scipy.optimize import linprog

MOST = 390


def chain(order, ts):
    """State (x, v, a[, j]) -> F state + g times what is held."""
    n = order
    f = np.zeros((n, n))
    factorial = [1, 1, 2, 6, 24]
    for i in range(n):
        for k in range(i, n):
            f[i, k] = ts ** (k - i) / factorial[k - i]
    return f, np.array([ts ** (n - i) / factorial[n - i] for i in range(n)])


def can(case, run, n):
    """Whether a programme of n scans ends on the law."""
    bounds = [b for b in case["slave"] if b is not None]
    order = len(bounds)
    if case["velocity"]:
        bounds[0] = min(bounds[0], case["velocity"])
    f, g = chain(order, case["cycle"])
    state = np.array([0.0, *run["start"]])[:order]
    pulse, column = [], g * bounds[-1]
    for _ in range(n):
        pulse.append(column)
        column = f @ column
    # The law goes one way, or rests.
    heading = next((np.sign(row[1]) for row in run["law"] if row[1] != 0.0), 0.0)
    low = np.array([-b for b in bounds[:-1]])
    high = np.array(bounds[:-1])
    if heading > 0:
        low[0] = min(0.0, state[1])
    elif heading < 0:
        high[0] = max(0.0, state[1])
    rows, right = [], []
    for k in range(1, n + 1):
        state = f @ state
        gain = np.zeros((order, n))
        gain[:, :k] = np.array(pulse[:k][::-1]).T
        if k < n:
            for i in range(1, order):
                scale = bounds[i - 1]
                rows += [gain[i] / scale, -gain[i] / scale]
                right += [(high[i - 1] - state[i]) / scale, (state[i] - low[i - 1]) / scale]
    goal = np.array(run["law"][n])[:order]
    scale = np.array(bounds[:-1])
    equal, value = gain[1:] / scale[:, None], (goal - state)[1:] / scale
    size = np.abs(gain[0]).max()
    ends = []
    for sign in (1, -1) if case["sync"] else (0,):
        result = linprog(
            sign * gain[0] / size, A_ub=np.array(rows) if rows else None, b_ub=right or None,
            A_eq=equal, b_eq=value, bounds=(-1, 1), method="highs",
        )
        if result.status != 0:
            return False
        ends.append(sign * result.fun * size + state[0])
    if not case["sync"]:
        return True
    slack = 1e-7 * max(abs(end) for end in (*ends, goal[0], 1e-9))
    return ends[0] - slack <= goal[0] <= ends[1] + slack


def least(case, run):
    low, high = 0, 8
    while not can(case, run, high):
        low, high = high, 2 * high
        if high > MOST:
            return None
    while high - low > 1:
        middle = (low + high) // 2
        if can(case, run, middle):
            high = middle
        else:
            low = middle
    return high


def rounded(value):
    return float(f"{value:.6g}")


def draw(rng, group, sync, number):
    if group == "far ahead":
        # As fast as the law, and so far ahead of it that the way to wait for it has a stretch of constant velocity.
        case = draw(rng, "constant", sync, number)
        velocity, cycle = case["slave"][0], case["cycle"]
        part = abs(case["master_velocity"]) * abs(case["numerator"]) / case["denominator"]
        more = rng.uniform(0.55, 0.85) * velocity / part
        case.update(
            name=f"far ahead {number}", master_velocity=rounded(case["master_velocity"] * more), slave_lead=90, velocity=0.0,
            slave_velocity=rounded(part * more), ahead=rounded(rng.uniform(30, 70) * velocity * cycle),
        )
        return case
    cycle = rng.choice([0.001, 0.002, 0.004, 0.005])
    velocity = 10 ** rng.uniform(1, 2.7)
    acceleration = velocity / (cycle * rng.uniform(6, 25))
    jerk = acceleration / (cycle * rng.uniform(3, 10))
    snap = jerk / (cycle * rng.uniform(1.5, 5))
    order = 3 if rng.random() < 0.12 else 4
    slave = [rounded(b) for b in (velocity, acceleration, jerk, snap)]
    numerator, denominator = rng.choice([(1, 1), (1, 2), (2, 1), (3, 7), (-1, 1), (-2, 3)])
    factor = abs(numerator) / denominator
    part = rng.uniform(0.1, 0.85)
    if group == "accelerating":
        # The law has up to four fifths of each bound, and the master sets off about when the slave does.
        share = [rng.uniform(0.3, 0.8) for _ in range(3)]
        master = [velocity / factor, *(s * b / factor for s, b in zip(share, slave[1:]))]
        ramp = part * slave[0] / (share[0] * slave[1]) + share[0] * slave[1] / (share[1] * slave[2])
        lead = int(rng.uniform(0, 0.7) * ramp / cycle)
    else:
        master = [velocity / factor, 10 * acceleration / factor, 50 * jerk / factor, 200 * snap / factor]
        lead = 60
    if order == 3:
        slave[3] = None
        if group == "accelerating":
            master[3] = 50 * snap / factor
    heading = 1 if numerator > 0 else -1
    own = rng.random()
    moves = own < 0.55
    return {
        "name": f"{group} {'in pos' if sync else 'in'} {number}", "group": group, "sync": sync, "cycle": cycle,
        "master": [rounded(b) for b in master], "slave": slave,
        "numerator": numerator, "denominator": denominator,
        "master_velocity": 0.0 if group == "rest" else rounded(heading * part * velocity / factor),
        "master_lead": lead,
        "master_halt": 0,
        # From rest, at its velocity, or on the ramp to it.
        "slave_velocity": rounded(rng.uniform(0.1, 0.9) * velocity) if moves else 0.0,
        "slave_lead": rng.randrange(4, 24) if own < 0.3 else 90,
        "velocity": rounded(rng.uniform(max(part + 0.1, 0.9), 1.0) * velocity) if sync and rng.random() < 0.3 else 0.0,
        "ahead": rounded(rng.uniform(-30, 20) * velocity * cycle) if sync else 0.0,
    }


def main():
    if sys.argv[1:2] == ["draw"]:
        rng = random.Random(int(sys.argv[2]))
        plan = [("rest", True, 16), ("constant", False, 18), ("constant", True, 44),
                ("accelerating", False, 8), ("accelerating", True, 16),
                ("far ahead", True, 8)]
        cases = [draw(rng, group, sync, number) for group, sync, count in plan for number in range(1, count + 1)]
    elif sys.argv[1:2] == ["solve"]:
        cases = json.load(open(sys.argv[2]))
        for case, run in zip(cases, json.load(open(sys.argv[2] + ".runs"))):
            case["least"] = least(case, run)
            print(case["name"], case["least"], run["took"], file=sys.stderr, flush=True)
    else:
        sys.exit(__doc__)
    print("[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]")


if __name__ == "__main__":
    main()
