#!/usr/bin/env python3
"""Whether what a subdomain carries as a whole predicts its stress some steps ahead.

usage: PYTHONPATH=postpro python3 -P postpro/experiments/subdomain_guesses.py RESULTS [FIRST_STEP]

RESULTS is a run in the plane with output.subdomain_means = true and output.record_every = 1. Prints, for the pressure and for half the
difference of the axial stresses of the grains of a subdomain, how far off guesses are: root mean squares over all subdomains and steps
from FIRST_STEP on, over the scatter of the value. Guesses: the mean of all, the last value, the mean of the last 100 steps, and a
law of flow, stress over pressure along the rate of strain, with the friction that fits the same run best.
"""

import sys

import numpy as np
from splitgrain_postpro.results import Results

LAGS, WINDOW = (0, 1, 10, 100), 100


def series(results, first):
    """Pressures, half differences of axial stresses, and directions of the strain rate, one row per step, one column per subdomain."""
    parts = [{key: value[part["step"] >= first] for key, value in part.items()} for part in results.subdomains.values()]

    def take(name):
        return np.array([part[name] for part in parts]).T

    xx, yy = take("grain_stress_xx"), take("grain_stress_yy")
    stretch = take("velocity_gradient_xx") - take("velocity_gradient_yy")
    rate = np.hypot(stretch, take("velocity_gradient_xy") + take("velocity_gradient_yx"))
    return (xx + yy) / 2, (yy - xx) / 2, stretch / np.maximum(rate, 1e-12)


def errors(values, law):
    """Errors of all guesses of values, lag by lag, over their scatter."""
    recent = np.cumsum(np.vstack([np.zeros(values.shape[1]), values]), 0)
    recent = (recent[WINDOW:] - recent[:-WINDOW]) / WINDOW  # row i: mean of the steps up to WINDOW - 1 + i
    start = WINDOW - 1
    for lag in LAGS:
        then = values[start + lag:]
        now = slice(start, len(values) - lag)
        guesses = {"mean": values.mean(), "last value": values[now], "last 100": recent[:len(then)]}
        if law is not None:
            guesses["law"] = law[now]
        yield lag, {name: np.sqrt(np.mean((then - guess) ** 2)) / values.std() for name, guess in guesses.items()}


def main(folder, first="1"):
    pressure, half, direction = series(Results(folder), int(first))
    along = pressure * direction
    friction = (half * along).sum() / (along**2).sum()
    print(f"{half.shape[1]} subdomains, {len(half)} steps; friction of the law {friction:.3f}")
    for name, values, law in (("pressure", pressure, None), ("half difference", half, friction * along)):
        step = np.abs(np.diff(values, axis=0)).mean() / np.abs(values).mean()
        print(f"{name}: mean {values.mean():.4g} Pa, scatter {values.std():.4g} Pa, mean change per step {100 * step:.1f} % of the mean")
        for lag, found in errors(values, law):
            print(f"  {lag:4d} steps ahead  " + "  ".join(f"{key} {error:.2f}" for key, error in found.items()))


if __name__ == "__main__":
    main(*sys.argv[1:])
