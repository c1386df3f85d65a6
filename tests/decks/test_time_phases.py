#!/usr/bin/env python3
"""Scenes of `input_decks/engines` with few grains: they come to rest, and steps of theirs are timed by phase: test_time_phases.py PROGRAM [MPIEXEC]"""

import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402
from time_phases import phases_of, summary  # noqa: E402

HERE = Path(__file__).resolve().parent
#: What makes each scene small: its grains, and the walls about them
PLANE = {"sample[1].count": 60, "sample[1].box": "[0, 0, 12, 14]", "wall[3].from": "[12.5, 0]", "wall[3].to": "[12.5, 120]",
         "wall[1].to": "[12, -0.5]"}
SPACE = {"sample[1].count": 60, "sample[1].box": "[0, 0, 0, 5, 5, 12]", "container[1].size": "[5, 5, 12]"}
SMALL = {"disks": PLANE, "polygons": PLANE, "spheres": SPACE, "polyhedra": SPACE}
PHASES = ("predict", "detect", "assemble", "solve", "update", "measure")


class Summary(unittest.TestCase):
    def test_means_of_the_cheapest_round_or_a_share_of_all_steps(self):
        rounds = [{"solve": [4.0, 2.0], "step": [9.0, 5.0]}, {"solve": [1.0, 3.0], "step": [10.0, 6.0]}]
        self.assertEqual(summary(rounds, None), {"solve": 3.0, "step": 7.0})
        self.assertEqual(summary(rounds, 0.1), {"solve": 1.0, "step": 5.0})
        self.assertEqual(summary(rounds, 0.5), {"solve": 3.0, "step": 9.0})

    def test_rows_of_several_steps_give_times_of_one(self):
        rows = [{"step": step} | {f"cpu_{name}": total for name in PHASES} for step, total in (("20", "0"), ("40", "1"), ("50", "1.5"))]
        phases = phases_of(rows, "cpu")
        self.assertEqual(phases["solve"], [50, 50])
        # All phases but the measures.
        self.assertEqual(phases["step"], [5 * 50, 5 * 50])


class TimePhases(ProgramCase):
    def rows(self, name, *more):
        """Rows that the driver prints for a small scene, each its columns by their names."""
        words = [sys.executable, HERE / "time_phases.py", self.program, HERE.parents[1] / f"input_decks/engines/{name}.toml",
                 "--steps", "5", "--rounds", "1", "--sweeps", "2", "4", *more]
        # The last ball rolls until step 1100 to 1300, by rounding.
        for key, value in (SMALL[name] | {"time.steps": 1500, "restart.every": 1500}).items():
            words += ["--set", f"{key}={value}"]
        done = subprocess.run(list(map(str, words)), cwd=self.place, capture_output=True, text=True, timeout=self.timeout)
        self.assertEqual(done.returncode, 0, done.stderr)
        head, _, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in done.stdout.splitlines())
        return [dict(zip(head, row, strict=True)) for row in rows]

    def test_scenes_rest_and_phases_are_there(self):
        if not self.has_hdf5():
            self.skipTest("no restart files without HDF5")
        # Random polyhedra are hulls.
        for name in SMALL if self.has_library("Qhull") else SMALL.keys() - {"polyhedra"}:
            with self.subTest(scene=name):
                (row,) = self.rows(name)
                carry, contacts = int(row["that carry"]), int(row["contacts"])
                # A grain at rest touches two others or more, few of which touch in more than one point.
                self.assertGreaterEqual(carry, 60)
                self.assertLessEqual(carry, contacts)
                self.assertLess(contacts, 60 * 20)
                # At rest: what two sweeps per step leave of g h, 0.04 m/s, and the weight on floor and walls.
                self.assertLess(float(row["mean speed, m/s"]), 4e-3)
                self.assertLess(float(row["mean overlap / r"]), 1e-2)
                self.assertAlmostEqual(float(row["floor share"]), 1, delta=0.02)
                for phase in PHASES:
                    self.assertGreaterEqual(float(row[phase]), 0, phase)
                self.assertGreater(float(row["step"]), 0)

    def test_a_share_of_steps(self):
        if not self.has_hdf5():
            self.skipTest("no restart files without HDF5")
        (row,) = self.rows("disks", "--share", "0.5")
        for phase in PHASES:
            self.assertGreaterEqual(float(row[phase]), 0, phase)

    def test_ranks_side_by_side(self):
        if not self.has_hdf5():
            self.skipTest("no restart files without HDF5")
        if self.launcher is None:
            self.skipTest("no MPI")
        one, two = self.rows("disks", "--launcher", self.launcher, "--ranks", "1", "2")
        self.assertEqual([one["program"], two["program"]], ["splitgrain", "splitgrain, 2 ranks"])
        self.assertEqual(one["contacts"], two["contacts"])
        for row in (one, two):
            self.assertGreater(float(row["step"]), 0)


if __name__ == "__main__":
    take_program()
    unittest.main()
