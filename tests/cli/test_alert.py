#!/usr/bin/env python3
"""Contacts that the motion of a step cannot close are left out, from outside: the motion of the grains is the one with all of them,
in the plane and in space, with substeps and on two ranks."""

import json
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

#: What all scenes have
COMMON = """
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
"""
#: Grains without friction, whose velocities have one solution, fall into a box
DECK = """
[scene]
dimension = {dimension}
kept_motion = 0.0

[time]
step = 1e-3
steps = 200
substeps = {substeps}
recovery = {recovery}
""" + COMMON + """
{walls}

[[sample]]
shape = "{shape}"
box = {box}
radius = [0.02, 0.03]
count = {count}
seed = 4
"""
WALL = "[[wall]]\nfrom = {}\nto = {}\nthickness = 0.02\n"
#: What is different in the plane and in space
PLANE = {"dimension": 2, "shape": "disk", "box": [0.0, 0.0, 0.6, 0.8], "count": 90,
         "walls": WALL.format([0.0, -0.01], [0.6, -0.01]) + WALL.format([-0.01, 0.0], [-0.01, 2.0]) +
         WALL.format([0.61, 0.0], [0.61, 2.0])}
POLYGONS = PLANE | {"shape": "polygon"}
SPACE = {"dimension": 3, "shape": "sphere", "box": [0.0, 0.0, 0.0, 0.25, 0.25, 0.5], "count": 120,
         "walls": "[[container]]\nsize = [0.25, 0.25, 1.0]\n"}
#: Solves to 1e-11 of the velocities, amplified by collisions: those of dozens of grains, by a few times each
CLOSE = 1e-7
#: The same where bodies are pushed apart: a push takes no contact in that lies beyond the reduced alert distance (7e-7 as measured)
PUSHED = 1e-5

#: A plank turns about its middle. A heavy disk of 1 mm/s arrives near the middle in the fourth step, of 10 ms, and throws the
#: end of the plank up 18 times as fast, against a disk that rests 0.1 mm above it. The fiftieth of that one's radius is 0.4 mm, the
#: reduced alert distance 0.06 mm.
LEVER = """
[scene]
gravity = [0.0, 0.0]

[time]
step = 1e-2
steps = 8
""" + COMMON + """
[[body]]
name = "plank"
shape = "polygon"
vertices = [[-0.5, -0.01], [0.5, -0.01], [0.5, 0.01], [-0.5, 0.01]]

[[drive]]
body = "plank"
component = "x"

[[drive]]
body = "plank"
component = "y"

[[body]]
name = "hammer"
shape = "disk"
radius = 2.0
position = [-0.02, 2.010035]
velocity = [0.0, -1e-3]

[[body]]
name = "target"
shape = "disk"
radius = 0.02
position = [0.48, 0.0301]
"""


class Alert(ProgramCase):
    def results_of(self, text, *words):
        """Record and summary of a run."""
        self.run_deck(text, *words)
        return self.rows(), json.loads((self.place / "out" / "run.json").read_text())

    def fall(self, keys, alert, substeps, recovery=0.0):
        """Those of grains that fall, with an alert distance or with those that follow the motion."""
        return self.results_of(DECK.format(alert=alert, substeps=substeps, recovery=recovery, **keys))

    def test_same_motion(self):
        """Grains move as they do with contacts of everything near; at first, when all is slow, few contacts are there."""
        scenes = [(keys, substeps, 0.0, CLOSE) for substeps in (1, 3) for keys in (PLANE, POLYGONS, SPACE)] + [(POLYGONS, 1, 3e-4, PUSHED)]
        for keys, substeps, recovery, close in scenes:
            with self.subTest(shape=keys["shape"], substeps=substeps, recovery=recovery):
                near, summary = self.fall(keys, "", substeps, recovery)
                wide, _ = self.fall(keys, "alert = 0.04", substeps, recovery)
                self.assertEqual(summary.get("recoveries", 0) > 2, recovery > 0)
                self.assertEqual(summary["fast_steps"], 0)
                self.assertLess(int(near[0]["contacts"]), int(wide[0]["contacts"]) / 2)
                self.assertLess(int(near[-1]["contacts"]), int(wide[-1]["contacts"]))
                self.assertGreater(int(near[-1]["active_contacts"]), 30)
                for one, other in zip(near, wide):
                    energy = float(other["kinetic_energy"])
                    self.assertLess(abs(float(one["kinetic_energy"]) - energy), close * energy, f"step {one['step']}")

    def test_solved_again(self):
        """A step whose solution is faster than was looked ahead is solved again, and misses nothing."""
        near, summary = self.results_of(LEVER.format(alert=""))
        wide, whole = self.results_of(LEVER.format(alert="alert = 0.04"))
        self.assertEqual(summary["repeated_steps"], 1)
        self.assertNotIn("repeated_steps", whole)
        self.assertEqual([int(row["active_contacts"]) for row in near], [int(row["active_contacts"]) for row in wide])
        self.assertEqual(max(int(row["active_contacts"]) for row in near), 2)
        for one, other in zip(near, wide):
            self.assertAlmostEqual(float(one["kinetic_energy"]) / float(other["kinetic_energy"]), 1, delta=1e-9)
        if self.has_hdf5():
            self.assertEqual(self.results_of(LEVER.format(alert=""), "--dump", "4")[0], near, "a dump changes nothing")

    def test_solved_again_in_substeps(self):
        """So is a step whose later substep finds out; works and counts of its first substeps count once."""
        for substeps, friction in ((2, 0.0), (5, 0.0), (5, 0.3)):
            with self.subTest(substeps=substeps, friction=friction):
                words = ["--set", f"time.substeps={substeps}", "--set", f"law.friction={friction}"]
                near, summary = self.results_of(LEVER.format(alert=""), *words)
                wide, whole = self.results_of(LEVER.format(alert="alert = 0.04"), *words)
                self.assertEqual(summary["repeated_steps"], 1)
                self.assertNotIn("repeated_steps", whole)
                self.assertEqual(summary["steps"], whole["steps"])
                self.assertLess(summary["energy_closure"], 1e-12)
                for one, other in zip(near, wide):
                    self.assertEqual(int(one["active_contacts"]), int(other["active_contacts"]))
                    for name in ("kinetic_energy", "impact_loss"):
                        self.assertAlmostEqual(float(one[name]), float(other[name]), delta=1e-9 * float(wide[0]["kinetic_energy"]))

    def test_given(self):
        """An alert distance of the deck is that of all steps."""
        first, _ = self.fall(PLANE, "alert = 0.04", 1)
        self.assertGreater(int(first[0]["contacts"]), 100)


if __name__ == "__main__":
    take_program()
    unittest.main()
