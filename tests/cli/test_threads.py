#!/usr/bin/env python3
"""Steps shared by threads, from outside: the record of a run is the same, digit by digit, for any number of
threads, in groups and in coloured order; with substeps, on ranks, and as subdomains of one process."""

import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

#: A dense sample that falls onto a wall, so large that threads share every loop of a step (least pieces times a few)
DECK = """
[scene]
dimension = {dimension}
gravity = [{gravity}]

[time]
step = 2e-3
steps = {steps}

[solver]
maximum_sweeps = 8
check_every = 4
tolerance = 1e-12

[output]
every = 0
record_every = 1

[restart]
every = {steps}

[[material]]
name = "stone"
density = 2000.0

[[law]]
friction = 0.4

[[interaction]]

{floor}

[[sample]]
kind = "lattice"
shape = "{shape}"
{sides}
box = [{box}]
radius = {radius}
spacing = 1.0
count = {count}
velocity = [{velocity}]
"""
PLANE = {"dimension": 2, "gravity": "0.0, -9.81", "box": "0.0, 0.0, 2.0, 2.0", "velocity": "0.3, -2.0", "radius": "[0.017, 0.018]",
         "count": 3000, "steps": 8, "floor": "[[wall]]\nfrom = [-1.0, -0.051]\nto = [3.0, -0.051]\nthickness = 0.1"}  # fmt: skip
SPACE = {"dimension": 3, "gravity": "0.0, 0.0, -9.81", "box": "0.0, 0.0, 0.0, 1.0, 1.0, 4.4", "velocity": "0.3, 0.1, -2.0",
         "radius": "[0.045, 0.046]", "count": 4000, "steps": 8, "floor": "[[container]]\nsize = [1.0, 1.0, 6.0]"}  # fmt: skip
SCENES = {
    "disks": PLANE | {"shape": "disk", "sides": ""},
    "polygons": PLANE | {"shape": "polygon", "sides": "sides = [5, 8]"},
    "spheres": SPACE | {"shape": "sphere", "sides": ""},
    "polyhedra": SPACE | {"shape": "polyhedron", "sides": "vertices = [8, 12]"},
}


class Threads(ProgramCase):
    def go(self, scene, output, *settings, ranks=1):
        """Rows of the record of a scene with some settings."""
        (self.place / "deck.toml").write_text(DECK.format(**SCENES[scene]))
        words = [word for setting in settings for word in ("--set", setting)]
        self.call("--quiet", *words, output=output, ranks=ranks)
        return self.rows(output)

    def alike(self, scene, *settings, numbers=(2, 3), least=1000, ranks=1):
        """Runs on several numbers of threads have the rows of that on one, and many contacts."""
        one = self.go(scene, "one", *settings, ranks=ranks)
        self.assertGreater(int(one[-1]["contacts"]), least)
        for threads in numbers:
            many = self.go(scene, "many", f"solver.threads={threads}", *settings, ranks=ranks)
            self.assertEqual(len(one), len(many))
            for row, other in zip(one, many):
                self.assertEqual(row, other, f"{scene}, {threads} threads")

    def test_orders(self):
        """Every kind of problem, in both orders that threads know."""
        for scene in SCENES:
            for order, threads in (("groups", 3), ("coloured", 2)):
                with self.subTest(scene=scene, order=order):
                    self.alike(scene, f'solver.order="{order}"', numbers=(threads,))

    def test_others(self):
        """Substeps, solves with momentum, and subdomains that take turns in one process, whose sweeps alone are shared."""
        self.alike("polygons", "time.substeps=3", 'solver.order="coloured"', numbers=(2,))
        self.alike("spheres", 'solver.method="nesterov"', 'solver.order="coloured"', numbers=(2,))
        self.alike("disks", "partition.parts=3", 'solver.order="coloured"', numbers=(2,))

    def test_ranks(self):
        """Two ranks of two threads each."""
        if not self.launcher:
            self.skipTest("a build without MPI has one rank")
        self.alike("disks", 'solver.order="coloured"', numbers=(2,), least=500, ranks=2)

    def test_small(self):
        """A scene of few contacts, whose loops the first thread runs alone."""
        self.alike("disks", "sample[1].count=40", 'solver.order="coloured"', numbers=(2,), least=10)


if __name__ == "__main__":
    take_program()
    unittest.main()
