#!/usr/bin/env python3
"""Stages as runs that go on from each other's checkpoints: friction, drives, pressures and gravity come and go.

usage: test_stages.py PROGRAM [unittest options]
"""

import csv
import re
import sys
import unittest
from math import pi
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

HEAD = """
[time]
step = 1e-3
steps = {steps}

[solver]
method = "nlgs"
criterion = "e8"
tolerance = 1e-12

[output]
record_every = 1

[scene]
dimension = {dimension}
gravity = {gravity}

[[material]]
name = "stone"
density = 1000.0

[[law]]
name = "rubbing"
friction = {friction}
"""
DISK = """
[[wall]]
name = "floor"
from = [-1.0, -0.01]
to = [9.0, -0.01]
thickness = 0.02

[[body]]
name = "ball"
shape = "disk"
radius = 0.1
position = [0.0, 0.1]
velocity = [1.0, 0.0]
"""
SPHERE = """
[[wall]]
name = "floor"
centre = [4.0, 0.0, 0.0]
normal = [0.0, 0.0, 1.0]
size = [12.0, 2.0]
thickness = 0.02

[[body]]
name = "ball"
shape = "sphere"
radius = 0.1
position = [0.0, 0.0, 0.1]
velocity = [1.0, 0.0, 0.0]
"""
PLATE = """
[[body]]
name = "plate"
shape = "polygon"
vertices = [[-0.5, -0.1], [0.5, -0.1], [0.5, 0.1], [-0.5, 0.1]]
position = [0.0, 1.0]
"""
HELD = "".join(f'\n[[drive]]\nbody = "plate"\ncomponent = "{c}"\n' for c in ("x", "y", "rotation"))
LIFTED = HELD.replace('"y"\n', '"y"\nvalue = 0.5\n')
PRESSED = '\n[[pressure]]\nbody = "plate"\ndirection = [0.0, 1.0]\nlength = 1.0\nvalue = 3000.0\n'
FLAT, FULL = [0.0, -10.0], [0.0, 0.0, -10.0]
ROUNDING = 1e-12
"""Works and energies of some hundred steps, relative to the largest: rounding of each is 1e-16."""


class Stages(ProgramCase):
    def setUp(self):
        super().setUp()
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")

    def stage(self, name, body, steps, after=None, friction=0.0, gravity=FLAT, code=0):
        """Run a stage of the same scene; what it prints."""
        text = HEAD.format(steps=steps, friction=friction, dimension=len(gravity), gravity=gravity) + body
        (self.place / f"{name}.toml").write_text(text)
        on = ["--restart", after] if after else []
        return self.run_program("run", f"{name}.toml", "--output", name, "--force", *on, code=code)

    def end(self, name):
        """Potential and kinetic energy of the body (walls rest at height zero), and how well all energies balance."""
        with open(self.place / name / "record.csv", newline="") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        last = rows[-1]
        return last["potential_energy"], last["kinetic_energy"], max(row["energy_closure"] for row in rows)

    def test_friction_comes_and_goes(self):
        """A ball that slides at 1 m/s rolls at 2/3 m/s (disk) or 5/7 m/s (sphere) once there is friction, whatever it is: from then on
        its kinetic energy is this share of that at the start."""
        for body, gravity, share, mass in ((DISK, FLAT, 2 / 3, 10 * pi), (SPHERE, FULL, 5 / 7, 4 / 3 * pi)):
            with self.subTest(gravity=gravity):
                first = self.stage("smooth", body, 100, gravity=gravity)
                self.assertRegex(first.stdout, "left out .*friction, rotation")
                second = self.stage("rough", body, 400, "smooth", 0.3, gravity)
                self.assertNotRegex(second.stdout, "left out .*(friction|rotation)")
                self.assertIn("time.steps = 400 (was 100), law[1].friction = 0.3 (was 0.0)", second.stderr)
                third = self.stage("smooth again", body, 500, "rough", 0.0, gravity)
                self.assertRegex(third.stdout, "left out .*friction")
                self.assertNotRegex(third.stdout, "left out .*rotation")
                for name, expected in (("smooth", 1.0), ("rough", share), ("smooth again", share)):
                    _, kinetic, closure = self.end(name)
                    self.assertAlmostEqual(kinetic / (mass / 2), expected, delta=ROUNDING)
                    self.assertLess(closure, ROUNDING)

    def test_components_are_held_driven_free_and_pressed(self):
        """Each stage has a closed form: rest, lifting at 0.5 m/s, a throw, a push of 3000 N against the weight of 2000 N."""
        self.stage("held", PLATE + HELD, 100)
        self.stage("lifted", PLATE + LIFTED, 300, "held")
        self.stage("thrown", PLATE, 400, "lifted")
        self.stage("pressed", PLATE + PRESSED, 600, "thrown")
        self.stage("held again", PLATE + HELD, 700, "pressed")
        after_lift = 1.0 + 0.2 * 0.5
        after_throw = after_lift + 0.1 * 0.5 - 10 * 0.1**2 / 2
        after_push = after_throw - 0.5 * 0.2 + 5 * 0.2**2 / 2
        weight = 2000.0
        for name, height, velocity in (("held", 1.0, 0.0), ("lifted", after_lift, 0.5), ("thrown", after_throw, -0.5),
                                       ("pressed", after_push, 0.5), ("held again", after_push, 0.0)):  # fmt: skip
            with self.subTest(stage=name):
                potential, kinetic, closure = self.end(name)
                # A step in which a drive begins or ends moves by the mean of both velocities.
                self.assertAlmostEqual(potential / weight, height, delta=0.5 * 1e-3)
                self.assertAlmostEqual(kinetic / (weight / 20), velocity**2, delta=ROUNDING)
                self.assertLess(closure, ROUNDING)

    def test_gravity_changes(self):
        """A ball thrown along the floor of a scene that is tilted by gravity: the balance closes over the change."""
        self.stage("level", DISK, 100)
        said = self.stage("tilted", DISK, 200, "level", gravity=[3.0, -8.0]).stderr
        self.assertIn("scene.gravity = [3.0, -8.0] (was [0.0, -10.0])", said)
        _, kinetic, closure = self.end("tilted")
        self.assertAlmostEqual(kinetic / (5 * pi), (1.0 + 3.0 * 0.1) ** 2, delta=ROUNDING)
        self.assertLess(closure, ROUNDING)

    def test_differences_are_named_or_counted(self):
        self.stage("first", PLATE + HELD, 10)
        said = self.stage("second", PLATE + PRESSED, 20, "first").stderr
        self.assertIn('pressure[1].body = "plate" (was not there)', said)
        self.assertRegex(said, r" and \d+ keys more$")
        (self.place / "first/effective.toml").unlink()
        said = self.stage("third", PLATE, 20, "first").stderr
        self.assertRegex(said.strip(), "written with another deck$")

    def test_other_scenes_are_refused(self):
        self.stage("first", DISK, 10)
        said = self.stage("second", DISK.replace("radius = 0.1", "radius = 0.11"), 20, "first", code=2).stderr
        self.assertTrue(re.search("of another scene: shapes or masses differ", said), said)


if __name__ == "__main__":
    take_program()
    unittest.main()
