#!/usr/bin/env python3
"""Railway ballast of the talk, small: the sample rests under its load, its checkpoint is tamped, and one number sets its size."""

import csv
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

DECKS = Path(__file__).resolve().parents[2] / "input_decks/talk/ballast"
# 248 stones that fall from half the height, in steps twice as long; the tines go deeper, as the bed is thin.
SMALL = [word for setting in (
    "constants.width=0.14", "sample[1].count=200", "sample[2].count=24", "sample[3].count=24", "body[1].position=[0.3,0.07,0.28]",
    "sample[1].box=[0,0,0,0.6,0.14,1.1]", "sample[2].box=[0,0,0.3,0.16,0.14,0.9]", "sample[3].box=[0.44,0,0.3,0.6,0.14,0.9]",
    "time.step=1.6e-3", "stage[4].until=mean_velocity<0.02") for word in ("--set", setting)]
WIDTH, LOAD, LIFT = 0.14, 4e3, 0.025
SLEEPER = 0.26 * (WIDTH - 0.02) * 0.2 * 2400 * 9.81


class Ballast(ProgramCase):
    def setUp(self):
        super().setUp()
        if not self.has_library("Qhull"):
            self.skipTest("hulls of stones need Qhull")

    def rows_of(self, folder, name, **wanted):
        """Rows of a file of results where columns have the values wanted."""
        with open(self.place / folder / name, newline="") as file:
            return [row for row in csv.DictReader(file) if all(row[key] == value for key, value in wanted.items())]

    def mean(self, rows, column):
        return sum(float(row[column]) for row in rows) / len(rows)

    def test_one_number_sets_the_size(self):
        """A slice half as wide has half of the 1500 stones; two sleepers have all bodies twice."""
        for sleepers, shapes in ((1, 759), (2, 1518)):
            words = ["--set", "constants.width=0.1", "--set", f"constants.sleepers={sleepers}"]
            printed = self.run_program("check", DECKS / "sample.toml", *words).stdout
            self.assertIn(f" {shapes} polyhedron", printed)

    def test_a_sample_rests_and_is_tamped(self):
        """At rest the bed carries the sleeper and its load; tamping lifts it straight, and the tines do work on the stones."""
        if not self.has_hdf5():
            self.skipTest("no HDF5")
        self.run_program("run", DECKS / "sample.toml", "--output", "sample", "--quiet", *SMALL)
        run = json.loads((self.place / "sample/run.json").read_text())
        self.assertIn("end condition", run["stages"][-1]["reason"])
        self.check_free_fall(run)
        rest = self.rows_of("sample", "tracks.csv", body="sleeper", stage="4")
        # Ten recorded steps in which the mean velocity was below 0.02 m/s; loads swing by some percent.
        self.assertAlmostEqual(self.mean(rest[-10:], "mean_force_z"), LOAD * WIDTH + SLEEPER, delta=0.05 * (LOAD * WIDTH + SLEEPER))
        raised = 125
        plunged = round(((0.55 - 0.1) / 0.8 + 0.02) / 1.6e-3 + 0.499)
        self.run_program("run", DECKS / "tamping.toml", "--restart", "sample", "--output", "tamped", "--quiet", *SMALL, "--set",
                         "constants.tip=0.1", "--set", f"time.steps={run['steps'] + raised + plunged + 10}")  # fmt: skip
        sleeper = self.rows_of("tamped", "tracks.csv", body="sleeper")
        # Within the first step, in which it is clamped, it still moves for half a step by the velocity that it had.
        half = 0.8e-3
        for name, way in (("x", 0.0), ("y", 0.0), ("z", LIFT)):
            moved = float(sleeper[-1][name]) - float(rest[-1][name])
            self.assertAlmostEqual(moved, way + half * float(rest[-1][f"velocity_{name}"]), delta=1e-9)
        turned = half * sum(abs(float(rest[-1][f"spin_{name}"])) for name in "xyz")
        for name in "wxyz":
            self.assertAlmostEqual(float(sleeper[-1][f"orientation_{name}"]), float(rest[-1][f"orientation_{name}"]), delta=turned)
        tines = {row["body"] for row in self.rows_of("tamped", "tracks.csv")} - {"sleeper"}
        self.assertEqual(len(tines), 8)
        work = 0.0
        for tine in tines:
            first, *_, last = self.rows_of("tamped", "tracks.csv", body=tine, stage="6")
            # The ramp of 0.04 s takes 0.02 s; the rest is at full speed.
            self.assertAlmostEqual(float(first["z"]) - float(last["z"]), 0.45, delta=0.02)
            work += float(last["contact_work"]) - float(first["contact_work"])
        self.assertLess(work, -1.0)
        below = self.rows_of("tamped", "regions.csv", region="below", stage="6")
        self.assertTrue(all(int(row["grains"]) > 5 for row in below))

    def check_free_fall(self, run):
        """Where the sleeper is placed it touches no stone: it falls freely, unloaded, down to the first one."""
        placed = self.rows_of("sample", "tracks.csv", body="sleeper", stage="2")
        first = placed[0]
        since = float(first["time"]) - run["stages"][0]["end_time"]
        self.assertGreater(since, 0)
        self.assertEqual((float(first["contact_work"]), float(first["mean_force_z"])), (0, 0))
        # The sum of a few additions of g h: exact up to their rounding.
        self.assertAlmostEqual(float(first["velocity_z"]), -9.81 * since, delta=1e-12)

    def test_a_sleeper_settles_under_cycles_of_load(self):
        """Eight cycles of load: contacts carry its mean and the weight, the sleeper sinks, and no overlap adds up to it."""
        if not self.has_hdf5():
            self.skipTest("no HDF5")
        self.run_program("run", DECKS / "settlement.toml", "--output", "settled", "--quiet", "--set", "solver.tolerance=1e-3",
                         "--set", "solver.maximum_sweeps=500", "--set", "constants.cycles=8", "--set",
                         "stage[5].solver.tolerance=1e-5")  # fmt: skip
        cycles = self.rows_of("settled", "tracks.csv", body="sleeper", stage="5")
        self.assertEqual(len(cycles), 8 * 5)
        before = self.rows_of("settled", "tracks.csv", body="sleeper", stage="4")[-1]
        sunk = float(before["y"]) - float(cycles[-1]["y"])
        self.assertGreater(sunk, 0)
        self.assertLess(sunk, 0.04)
        # The mean of load from 1 to 60 kN, and the weight of 0.26 m x 0.2 m of concrete; the sleeper ends at rest to within 0.05 m/s.
        carried = 30.5e3 + 0.26 * 0.2 * 2400 * 9.81
        momentum = 0.26 * 0.2 * 2400 * 0.05 / (8 / 20)
        self.assertAlmostEqual(self.mean(cycles, "mean_force_y"), carried, delta=momentum + 0.002 * carried)
        overlap = self.rows_of("settled", "regions.csv", region="below", stage="5")
        self.assertTrue(all(float(row["volume_error"]) < 1e-3 for row in overlap))

    def test_a_sleeper_in_space_carries_cycles_of_load(self):
        """Four cycles in space, of half the stones: contacts carry the mean load and the weight, and no overlap adds up to it."""
        if not self.has_hdf5():
            self.skipTest("no HDF5")
        self.run_program("run", DECKS / "settlement_in_space.toml", "--output", "settled", "--quiet", "--set", "constants.cycles=4",
                         "--set", "sample[1].count=100", "--set", "sample[2].count=12", "--set", "sample[3].count=12",
                         "--set", "stage[5].solver.tolerance=1e-4")  # fmt: skip
        cycles = self.rows_of("settled", "tracks.csv", body="sleeper", stage="5")
        self.assertEqual(len(cycles), 4 * 5)
        before = self.rows_of("settled", "tracks.csv", body="sleeper", stage="4")[-1]
        self.assertLess(abs(float(before["z"]) - float(cycles[-1]["z"])), 0.02)
        # The mean of load from 4 to 60 kN/m on 0.14 m, and the weight of a box of concrete; it ends at rest to within 0.05 m/s.
        mass = 0.26 * 0.12 * 0.2 * 2400
        carried = 32e3 * 0.14 + mass * 9.81
        self.assertAlmostEqual(self.mean(cycles, "mean_force_z"), carried, delta=mass * 0.05 / (4 / 20) + 0.002 * carried)
        overlap = self.rows_of("settled", "regions.csv", region="below", stage="5")
        self.assertTrue(all(float(row["volume_error"]) < 1e-3 for row in overlap))


if __name__ == "__main__":
    take_program()
    unittest.main()
