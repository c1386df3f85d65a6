#!/usr/bin/env python3
"""Contacts that the motion of a step cannot close are left out, from outside: the motion of the grains is the one with all of them,
in the plane and in space, with substeps and on two ranks."""

import csv
import json
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

#: Grains without friction, whose velocities have one solution, fall into a box
DECK = """
[scene]
dimension = {dimension}

[time]
step = 1e-3
steps = 200
substeps = {substeps}

[solver]
criterion = "e8"
tolerance = 1e-11
maximum_sweeps = 100000

[output]
record_every = 1

[[material]]
name = "stone"
density = 2500.0

[[law]]
friction = 0.0

[[interaction]]
{alert}

{walls}

[[sample]]
box = {box}
radius = [0.02, 0.03]
count = {count}
seed = 4
"""
WALL = "[[wall]]\nfrom = {}\nto = {}\nthickness = 0.02\n"
#: What is different in the plane and in space
PLANE = {"dimension": 2, "box": [0.0, 0.0, 0.6, 0.8], "count": 90,
         "walls": WALL.format([0.0, -0.01], [0.6, -0.01]) + WALL.format([-0.01, 0.0], [-0.01, 2.0]) +
         WALL.format([0.61, 0.0], [0.61, 2.0])}
SPACE = {"dimension": 3, "box": [0.0, 0.0, 0.0, 0.25, 0.25, 0.5], "count": 120,
         "walls": "[[container]]\nsize = [0.25, 0.25, 1.0]\n"}
#: Solves to 1e-11 of the velocities, amplified by collisions: those of dozens of grains, by a few times each
CLOSE = 1e-7


class Alert(ProgramCase):
    def run_deck(self, keys, alert, substeps):
        """Record and summary of a run, with an alert distance or with those that follow the motion."""
        (self.place / "deck.toml").write_text(DECK.format(alert=alert, substeps=substeps, **keys))
        self.run_program("run", "deck.toml", "--quiet", "--force", "--output", "out")
        with (self.place / "out" / "record.csv").open() as file:
            return list(csv.DictReader(file)), json.loads((self.place / "out" / "run.json").read_text())

    def test_same_motion(self):
        """Grains move as they do with contacts of everything near; at first, when all is slow, few contacts are there."""
        for keys, substeps in ((PLANE, 1), (SPACE, 1), (PLANE, 3)):
            with self.subTest(dimension=keys["dimension"], substeps=substeps):
                near, summary = self.run_deck(keys, "", substeps)
                wide, _ = self.run_deck(keys, "alert = 0.04", substeps)
                self.assertEqual(summary["fast_steps"], 0)
                self.assertLess(int(near[0]["contacts"]), int(wide[0]["contacts"]) / 2)
                self.assertLess(int(near[-1]["contacts"]), int(wide[-1]["contacts"]))
                self.assertGreater(int(near[-1]["active_contacts"]), 30)
                for one, other in zip(near, wide):
                    energy = float(other["kinetic_energy"])
                    self.assertLess(abs(float(one["kinetic_energy"]) - energy), CLOSE * energy, f"step {one['step']}")

    def test_given(self):
        """An alert distance of the deck is that of all steps."""
        first, _ = self.run_deck(PLANE, "alert = 0.04", 1)
        self.assertGreater(int(first[0]["contacts"]), 100)


if __name__ == "__main__":
    take_program()
    unittest.main()
