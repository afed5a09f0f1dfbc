"""Least numbers of samples for velocity ramps, by linear programming: writes least_samples.json.

python3 least_samples.py SEED COUNT > least_samples.json     (needs SciPy)

A case is a start (v, a, j), a goal velocity and bounds with the snap bound 1. A program of N samples holds any
snap in [-1, 1] for each whole sample, is integrated exactly, has its bounds on a and j checked at the samples,
and must end with (goal, 0, 0). The least N for which the program has a solution is `samples`. A continuous
ramp may switch between samples, so its time is at most samples * cycle, up to what the bounds overshoot
between samples; it cannot be shorter by more than the few samples that whole-sample holds cost.
"""

import json
import random
import sys

import numpy as np
from scipy.optimize import linprog


def solvable(case, cycle, samples):
    h = cycle
    n = samples
    k = np.arange(1, n + 1)[:, None]
    i = np.arange(n)[None, :]
    later = (k - i - 1) * h  # time from the end of sample i to instant k
    held = i < k
    jerk = np.where(held, h, 0.0)
    acceleration = np.where(held, h * (later + h / 2), 0.0)
    velocity = np.where(held, h * (later**2 / 2 + later * h / 2 + h * h / 6), 0.0)
    t = k[:, 0] * h
    free_j = np.full(n, case["jerk"])
    free_a = case["acceleration"] + case["jerk"] * t
    free_v = case["velocity"] + case["acceleration"] * t + case["jerk"] * t * t / 2
    bounds_a = (-case["deceleration_bound"], case["acceleration_bound"])
    rows, right = [], []
    for matrix, free, low, high in (
        (acceleration, free_a, *bounds_a),
        (jerk, free_j, -case["jerk_bound"], case["jerk_bound"]),
    ):
        if np.isfinite(high):
            rows += [matrix, -matrix]
            right += [high - free, free - low]
    end = np.array([velocity[-1], acceleration[-1], jerk[-1]])
    goal = np.array([case["goal"] - free_v[-1], -free_a[-1], -free_j[-1]])
    scale = np.array([1 / h**3, 1 / h**2, 1 / h])[:, None]
    # Every row in units of what one sample changes, or the solver's tolerance is coarse.
    a_ub = np.vstack([r / h ** (2 - (m // 2)) for m, r in enumerate(rows)])
    b_ub = np.hstack([r / h ** (2 - (m // 2)) for m, r in enumerate(right)])
    result = linprog(
        np.zeros(n), A_ub=a_ub, b_ub=b_ub, A_eq=end * scale, b_eq=goal * scale[:, 0],
        bounds=(-1, 1), method="highs",
    )
    return result.status == 0


def least(case, cycle):
    high = 8
    while not solvable(case, cycle, high):
        high *= 2
        if high > 1024:
            return None
    low = high // 2 if high > 8 else 0
    while high - low > 1:
        middle = (low + high) // 2
        if solvable(case, cycle, middle):
            high = middle
        else:
            low = middle
    return high


def draw(rng):
    jerk = 10 ** rng.uniform(-0.7, 0.7)
    up = jerk * 10 ** rng.uniform(-0.7, 0.9)
    down = up * (1 if rng.random() < 0.4 else 10 ** rng.uniform(-0.6, 0.6))
    while True:
        a = rng.uniform(-down, up)
        j = rng.uniform(-jerk, jerk)
        if rng.random() < 0.2:
            a = j = 0.0
        if -down <= a + j * abs(j) / 2 <= up:
            break
    base = 1000.0  # far from zero, so that the signs of the bounds never change
    time = 10 ** rng.uniform(-0.5, 1.0)
    return {
        "velocity": base, "acceleration": a, "jerk": j,
        "goal": base + a * time + rng.choice((-1, 1)) * (up if rng.random() < 0.5 else down) * time * rng.random(),
        "acceleration_bound": up, "deceleration_bound": down, "jerk_bound": jerk,
    }


def main():
    seed, count = int(sys.argv[1]), int(sys.argv[2])
    rng = random.Random(seed)
    cases = []
    while len(cases) < count:
        case = draw(rng)
        cycle = 1.0
        # A cycle for which the ramp takes about 100 samples.
        rough = least(case, 0.2)
        if rough is None:
            continue
        cycle = 0.2 * rough / 100
        samples = least(case, cycle)
        case.update(cycle=cycle, samples=samples)
        cases.append(case)
        print(len(cases), samples, file=sys.stderr)
    lines = ",\n".join(json.dumps(case) for case in cases)
    print(f'{{"seed": {seed}, "cases": [\n{lines}\n]}}')


if __name__ == "__main__":
    main()
