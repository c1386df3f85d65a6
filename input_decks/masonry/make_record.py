#!/usr/bin/env python3
"""Write a synthetic accelerogram as velocities of the ground: make_record.py > shaken_wall.txt

Three harmonics in an envelope that rises, holds and falls, as a strong motion does; the columns are the time [s] and the velocities
[m/s] of the same record with peak accelerations of 0.5 g and 0.8 g."""

import math

STEP, END, G = 0.01, 2.5, 9.81


def record():
    """Rows of time, velocity at 0.5 g, velocity at 0.8 g: accelerations are linear in each step, velocities their integral."""
    n = round(END / STEP)
    times = [STEP * k for k in range(n + 1)]
    envelope = [min(1.0, t / 0.5, (END - t) / 1.0) for t in times]
    shape = [e * (math.sin(2 * math.pi * 1.8 * t) + 0.7 * math.sin(2 * math.pi * 3.1 * t + 1.0) + 0.4 * math.sin(2 * math.pi * 5.3 * t))
             for e, t in zip(envelope, times, strict=True)]
    # Of a velocity that is linear in each step the acceleration is that between two rows.
    means = [(a + b) / 2 for a, b in zip(shape, shape[1:], strict=False)]
    drift = sum(means) / n
    means = [mean - drift for mean in means]
    largest = max(map(abs, means))
    velocity, rows = 0.0, [(0.0, 0.0, 0.0)]
    for time, mean in zip(times[1:], means, strict=True):
        velocity += STEP * mean / largest * G
        rows.append((time, 0.5 * velocity, 0.8 * velocity))
    return rows


if __name__ == "__main__":
    for row in record():
        print("{:.2f} {:.9f} {:.9f}".format(*row))
