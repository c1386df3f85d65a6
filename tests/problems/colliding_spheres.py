#!/usr/bin/env python3
"""Print a deck: spheres on a jittered close packing that run together with random velocities, for one step.

usage: colliding_spheres.py [SEED [COUNT]] > deck.toml
       splitgrain run deck.toml --dump 1 --set solver.maximum_sweeps=5
"""

import random
import sys

PITCH = 0.0275 / 2**0.5  # m, half the side of a cube of the close packing
HEAD = """[scene]
dimension = 3
gravity = [0.0, 0.0, 0.0]

[time]
step = 5e-4
steps = 1

[[material]]
name = "glass"
density = 2500.0

[[law]]
friction = 0.5
"""


def deck(seed, count, speed=20.0, inward=200.0, jitter=0.0005):
    """The spheres nearest to the origin: random velocities [m/s] plus one towards it, per metre [1/s]."""
    draw = random.Random(seed).uniform
    side = range(-8, 9)
    centres = sorted(((i * PITCH, j * PITCH, k * PITCH) for i in side for j in side for k in side if (i + j + k) % 2 == 0),
                     key=lambda p: (sum(c * c for c in p), p))
    text = [HEAD]
    for centre in centres[:count]:
        position = [c + draw(-jitter, jitter) for c in centre]
        velocity = [draw(-speed, speed) - inward * c for c in centre]
        spin = [draw(-speed, speed) / 0.012 for _ in range(3)]
        text.append(f"[[body]]\nshape = \"sphere\"\nradius = {draw(0.0115, 0.0131)}\nposition = {position}\n"
                    f"velocity = {velocity}\nspin = {spin}\n")
    return "\n".join(text)


if __name__ == "__main__":
    print(deck(*(int(word) for word in (sys.argv[1:] + ["2", "600"][len(sys.argv) - 1:])[:2])), end="")
