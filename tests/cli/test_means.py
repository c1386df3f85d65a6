#!/usr/bin/env python3
"""Means over the recorded interval, and the worst contacts of a run, from outside: the law of momentum, sums of single steps,
restarts bit for bit, several ranks; bodies, step, place and cause of the deepest penetration."""

import csv
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

G = 9.81
START = """[scene]
dimension = {dimension}
[time]
step = 1e-3
steps = {steps}
[solver]
criterion = "e8"
tolerance = {tolerance}
[output]
record_every = {every}
record_mean = true
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.3
"""
# Rounding of sums of some hundred impulses over a few steps.
ROUNDING = 1e-11


def wall(name, first, second):
    return f'[[wall]]\nname = "{name}"\nfrom = {first}\nto = {second}\nthickness = 0.1\n'


def shaken(is_in_space, steps=200, every=7):
    """Grains fall into a box whose floor shakes."""
    start = START.format(dimension=3 if is_in_space else 2, steps=steps, every=every, tolerance=1e-6)
    if is_in_space:
        box = '[[container]]\nsize = [0.3, 0.3, 0.4]\n[[drive]]\nbody = "box.floor"\ncomponent = "z"\n'
        grains = '[[sample]]\nshape = "sphere"\nbox = [0.0, 0.0, 0.01, 0.3, 0.3, 0.3]\ncount = 40\nradius = [0.02, 0.03]\n'
    else:
        box = wall("floor", [-0.1, -0.05], [0.6, -0.05]) + wall("left", [-0.05, -0.1], [-0.05, 0.7])
        box += wall("right", [0.45, -0.1], [0.45, 0.7]) + '[[drive]]\nbody = "floor"\ncomponent = "y"\n'
        grains = '[[sample]]\nkind = "random"\nbox = [0.0, 0.01, 0.4, 0.5]\ncount = 40\nradius = [0.02, 0.03]\n'
    return start + box + "amplitude = 0.3\nfrequency = 20.0\n" + grains


class Means(ProgramCase):
    def run_deck(self, text, *words, output="out", code=0):
        (self.place / "deck.toml").write_text(text)
        return self.run_program("run", "deck.toml", "--output", output, "--force", *words, code=code)

    def record(self, output="out"):
        """Rows of the record without what clocks count."""
        with (self.place / output / "record.csv").open(newline="") as file:
            return [{name: float(value) for name, value in row.items() if not name.startswith(("cpu", "wall_"))}
                    for row in csv.DictReader(file)]

    def run_json(self, output="out"):
        return json.loads((self.place / output / "run.json").read_text())

    def test_momentum(self):
        """Walls take what the grains lose of their momentum and what gravity gives them, over each interval, also with substeps."""
        for is_in_space in (False, True):
            for substeps in (1, 2):
                with self.subTest(is_in_space=is_in_space, substeps=substeps):
                    self.run_deck(shaken(is_in_space), "--set", f"time.substeps={substeps}", "--quiet")
                    rows, up = self.record(), "yz"[is_in_space]
                    held = [row for row in rows if row["mean_floor_share"] > 0]
                    mass = -held[-1]["mean_wall_force_" + up] / (G * held[-1]["mean_floor_share"])
                    self.assertGreater(max(row["mean_wall_force_" + up] for row in rows) - min(
                        row["mean_wall_force_" + up] for row in rows), mass * G)
                    for before, row in zip(rows, rows[1:]):
                        span = row["time"] - before["time"]
                        for axis in "xyz"[:2 + is_in_space]:
                            lost = before["momentum_" + axis] - row["momentum_" + axis] - mass * G * span * (axis == up)
                            self.assertLessEqual(abs(row["mean_wall_force_" + axis] * span - lost), ROUNDING * mass * 10)

    def test_steps(self):
        """Over one step the means are its own values; over ten the mean of ten of them, where the formula is a mean."""
        self.run_deck(shaken(False, 100, 1), "--quiet")
        single = self.record()
        names = [name[5:] for name in single[0] if name.startswith("mean_") and name[5:] in single[0]]
        self.assertEqual(len(names), 1 + 1 + 1 + 4 + 3 + 2)
        for row in single:
            for name in names:
                self.assertLessEqual(abs(row["mean_" + name] - row[name]), 1e-12 * abs(row[name]) + 1e-9 * (name == "stress_xy"), name)
        self.run_deck(shaken(False, 100, 10), "--quiet")
        for i, row in enumerate(self.record()):
            part = single[10 * i:10 * i + 10]
            self.assertEqual(part[-1]["step"], row["step"])
            for name in ("kinetic_energy", "floor_share"):
                mean = sum(step[name] for step in part) / 10
                self.assertLessEqual(abs(row["mean_" + name] - mean), 1e-12 * max(abs(step[name]) for step in part))
        names = ("mean_wall_force_x", "mean_wall_force_y", "mean_stress_xx", "mean_stress_yy", "mean_fabric_xx", "mean_fabric_yy",
                 "mean_mobilised_friction", "mean_sliding_share")
        self.assertLessEqual(set(names), set(single[0]))
        self.assertEqual(self.run_json()["mean_kinetic_energy"], self.record()[-1]["mean_kinetic_energy"])

    def test_end_condition(self):
        """Means may end a run; without record_mean there are none, and the condition is a mistake."""
        stop = '[stop]\nwhen = "mean_floor_share > 0.2"\n'
        self.run_deck(shaken(False) + stop, "--quiet")
        self.assertGreater(self.run_json()["stop_value"], 0.2)
        self.run_deck(shaken(False), "--set", "output.record_mean=false", "--quiet")
        self.assertNotIn("mean_pressure", self.record()[0])
        self.assertIn("mean_floor_share", self.run_deck(shaken(False) + stop, "--set", "output.record_mean=false", code=2).stderr)

    def test_restart(self):
        """A run that goes on from a checkpoint between two rows, or at one, has the very same rows and the same worst contacts."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        for is_in_space in (False, True):
            words = ("--set", "restart.every=77", "--set", "restart.at_end=false", "--quiet")
            self.run_deck(shaken(is_in_space), *words)
            straight, run = self.record(), self.run_json()
            for file in ("restart_a.h5", "restart_b.h5"):
                with self.subTest(is_in_space=is_in_space, file=file):
                    self.run_deck(shaken(is_in_space), *words, "--restart", f"out/{file}", output=f"{file}{is_in_space}")
                    rows = self.record(f"{file}{is_in_space}")
                    self.assertEqual(rows, straight[-len(rows):])
                    again = self.run_json(f"{file}{is_in_space}")
                    for name in run:
                        if name.startswith("worst_"):
                            self.assertEqual(again[name], run[name], name)

    def test_ranks(self):
        """The same subdomains on one rank and on three: the same rows, the same worst contacts."""
        if not self.launcher:
            self.skipTest("no MPI")
        for is_in_space in (False, True):
            found = []
            for ranks in (1, 3):
                self.on_ranks(ranks, shaken(is_in_space), "ranks", "--set", "partition.parts=3")
                worst = {name: value for name, value in self.run_json("ranks").items() if name.startswith("worst_")}
                self.assertGreater(worst["worst_penetration_step"], 0)
                self.assertGreater(worst["worst_penetration_body_1"], 0)
                self.assertEqual("worst_penetration_z" in worst, is_in_space)
                self.assertEqual("mean_stress_zz" in self.record("ranks")[0], is_in_space)
                self.assertEqual("mean_fabric_zz" in self.record("ranks")[0], is_in_space)
                self.assertEqual("mean_wall_force_z" in self.record("ranks")[0], is_in_space)
                self.assertGreater(worst["worst_violation_step"], 0)
                self.assertIn(worst.get("worst_violation_hint", ""), ("", "pushed by a driven body", "the step did not converge",
                                                              "a shock, try shorter steps"))
                found.append((self.record("ranks"), worst))
            self.assertEqual(*found)

    def test_shock(self):
        """A disk hits the floor at 10 m/s, and is stopped when it is in it: the verdict names both, the step of the impact, the place, and a shock."""
        ball = '[[body]]\nname = "ball"\nshape = "disk"\nradius = 0.05\nposition = [0.2, 0.1533]\nvelocity = [0.0, -10.0]\n'
        text = START.format(dimension=2, steps=30, every=1, tolerance=1e-10) + 'kind = "VEL_SGR_CLB"\n'
        text += wall("floor", [-0.5, -0.05], [0.6, -0.05]) + ball
        said = self.run_deck(text).stdout
        run = self.run_json()
        deepest = max(self.record(), key=lambda row: row["max_penetration"])
        self.assertEqual(run["worst_penetration"], deepest["max_penetration"])
        self.assertEqual([run["worst_penetration_step"], run["worst_penetration_time"]], [deepest["step"], deepest["time"]])
        self.assertEqual({run["worst_penetration_body_1"], run["worst_penetration_body_2"]}, {1, 2})
        self.assertIn(run["worst_penetration_bodies"], ('"ball" and "floor"', '"floor" and "ball"'))
        self.assertAlmostEqual(run["worst_penetration_x"], 0.2)
        self.assertLess(abs(run["worst_penetration_y"]), 0.01)
        self.assertEqual(run["worst_penetration_hint"], "a shock, try shorter steps")
        self.assertRegex(said, rf"deepest +step {run['worst_penetration_step']} \(.* s\), .*ball.* at \(.*\) m: a shock")

    def test_driven(self):
        """A plate comes down on a disk on the floor: the deepest contact is that of the last step, under the plate or over the floor."""
        text = START.format(dimension=2, steps=100, every=10, tolerance=1e-10) + wall("floor", [-0.5, -0.05], [0.6, -0.05])
        text += wall("plate", [-0.5, 0.16], [0.6, 0.16]) + "velocity = [0.0, -0.2]\n"
        text += '[[body]]\nname = "disk"\nshape = "disk"\nradius = 0.05\nposition = [0.2, 0.05]\n'
        self.run_deck(text, "--set", "guard.energy=ignore")
        run = self.run_json()
        self.assertEqual(run["worst_penetration_step"], 100)
        self.assertIn('"disk"', run["worst_penetration_bodies"])
        if '"plate"' in run["worst_penetration_bodies"]:
            self.assertEqual(run["worst_penetration_hint"], "pushed by a driven body")


if __name__ == "__main__":
    take_program()
    unittest.main()
