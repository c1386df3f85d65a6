#!/usr/bin/env python3
"""The same scene by other ways through the program: stopped and restarted, converted to DATBOX files and back, on several ranks.

Usage: test_round_trips.py PROGRAM MPIEXEC [TEST ...]

Where bodies are and how they move at the end, as DOF.INI holds it (eight digits), is what the straight run gives: digit by digit after
a restart, to TOLERANCE otherwise. Scenes in other axes, units and shapes: tests/physics/test_metamorphic.f90.
"""

import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

STEPS = 60
# Of displacements [m] and velocities [m/s, rad/s]: files of DATBOX hold eight digits, ranks stop at an e8 of 1e-11 in each step.
TOLERANCE = 1e-6
COMMON = f"""[time]
step = 2e-3
steps = {STEPS}
[solver]
criterion = "e8"
tolerance = 1e-11
check_every = 5
maximum_sweeps = 20000
[[material]]
name = "stone"
density = 2600.0
[[law]]
"""
FLOOR = """[[wall]]
from = [-1.0, -0.05]
to = [3.0, -0.05]
thickness = 0.1
[[body]]
shape = "polygon"
fixed = true
angle = 0.4
position = [2.5, 0.0]
vertices = [[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]]
"""
GROUND = """[scene]
dimension = 3
[[wall]]
centre = [0.5, 0.0, 0.0]
size = [4.0, 4.0]
thickness = 0.1
"""


def disk(i, more=""):
    return f'[[body]]\nshape = "disk"\nradius = {0.1 + 0.01 * i}\nposition = [{0.36 * i - 0.5}, {0.13 + 0.03 * i}]\n{more}'


def block(i):
    return (f'[[body]]\nshape = "polygon"\nangle = {0.3 * i}\nposition = [{0.36 * i - 0.5}, 0.55]\nspin = {1 - 0.3 * i}\n'
            f"vertices = [[-0.1, -0.08], [0.1, -0.08], [0.12, 0.05], [0.0, 0.1], [-0.1, 0.07]]\n")


def ball(i):
    return f'[[body]]\nshape = "sphere"\nradius = {0.1 + 0.01 * i}\nposition = [{0.3 * i}, {0.02 * i}, {0.13 + 0.02 * i}]\n'


def brick(i):
    return (f'[[body]]\nshape = "box"\nhalf_axes = [0.1, 0.08, 0.06]\nposition = [{0.3 * i}, 0.03, 0.45]\n'
            f"rotation = [0.3, {0.2 * i}, -0.4]\nvelocity = [0.1, 0.0, -1.0]\n")


SCENES = {
    "disks without friction": COMMON + FLOOR + "".join(map(disk, range(7))),
    "disks and polygons": COMMON + "friction = 0.4\n" + FLOOR + "".join(map(disk, range(5))) + "".join(map(block, range(5))),
    "sliding and sticking": COMMON + "static_friction = 0.5\ndynamic_friction = 0.2\n" + FLOOR
                            + "".join(disk(i, "velocity = [1.0, 0.0]\n") for i in range(6)),
    "spheres": COMMON + "friction = 0.3\n" + GROUND + "".join(map(ball, range(6))),
    "spheres and boxes": COMMON + GROUND + "".join(map(ball, range(4))) + "".join(map(brick, range(4))),
}


class RoundTrips(ProgramCase):
    straight = {}
    """States at the end of straight runs, by scene: each is run once"""

    def run_deck(self, deck, output, *words, ranks=1):
        """Run a deck, and give the state at its end as text."""
        words = ["run", deck, "--quiet", "--output", output, "--set", f"restart.every={STEPS // 2}", *words]
        self.run_program(*words, ranks=ranks)
        return self.state(deck, output)

    def state(self, deck, output):
        folder = f"{output} datbox"
        self.run_program("convert", deck, folder, "--restart", output)
        return (self.place / folder / "DOF.INI").read_text()

    def compare(self, one, other):
        one, other = ([float(x.replace("D", "e")) for x in re.findall(r"[-+ ]\d\.\d+D[-+]\d+", text)] for text in (one, other))
        self.assertGreater(max(map(abs, one)), 0.1)
        self.assertEqual(len(one), len(other))
        self.assertLess(max(abs(a - b) for a, b in zip(one, other)), TOLERANCE)

    def each_scene(self):
        if not self.has_hdf5():
            self.skipTest("states are read from checkpoints")
        for i, (name, text) in enumerate(SCENES.items()):
            deck = f"deck {i}.toml"
            (self.place / deck).write_text(text)
            if i not in self.straight:
                self.straight[i] = self.run_deck(deck, f"straight {i}")
            yield name, i, deck, self.straight[i]

    def test_restarted(self):
        for name, i, deck, straight in self.each_scene():
            with self.subTest(name):
                self.run_deck(deck, f"half {i}", "--set", f"time.steps={STEPS // 2}")
                self.assertEqual(self.run_deck(deck, f"second half {i}", "--restart", f"half {i}"), straight)

    def test_converted(self):
        options = [word for line in COMMON.splitlines()[1:8] if "=" in line
                   for word in ("--set", ("time." if "step" in line.split("=")[0] else "solver.") + line.replace(" ", ""))]
        for name, i, deck, straight in self.each_scene():
            with self.subTest(name):
                self.run_program("convert", deck, f"files {i}")
                self.run_program("convert", f"files {i}", f"back {i}.toml")
                self.compare(self.run_deck(f"back {i}.toml", f"converted {i}", *options), straight)

    def test_on_ranks(self):
        if not self.launcher:
            self.skipTest("one rank")
        for name, i, deck, straight in self.each_scene():
            # Two and three in turn, of which the plane and space each have some.
            ranks = 2 + i % 2
            with self.subTest(name, ranks=ranks):
                self.compare(self.run_deck(deck, f"on {ranks} ranks {i}", ranks=ranks), straight)


if __name__ == "__main__":
    take_program()
    unittest.main()
