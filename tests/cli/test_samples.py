#!/usr/bin/env python3
"""Samples from outside: sizes from sieve curves, samples in one box that keep clear of each other, clumps, stones, mistakes."""

import csv
import json
import re
import resource
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

SCENE = """[scene]
dimension = 3
gravity = [0.0, 0.0, 0.0]
[time]
step = 1e-4
steps = 1
[[material]]
name = "stone"
density = 1.0
[[law]]
friction = 0.5
"""
SAMPLE = """[[sample]]
shape = "polyhedron"
box = [0.0, 0.0, 0.0, 0.6, 0.6, 0.6]
SIZE
count = 150
"""
PLANE = """[time]
step = 1e-4
steps = 1
PERIOD
[[material]]
name = "sand"
density = 1.0
[[law]]
friction = 0.5
"""
FINE_AND_COARSE = """[[sample]]
box = [0.0, 0.0, 1.0, 1.0]
radius = 0.1
fill = 0.3
[[sample]]
box = [0.0, 0.0, 1.0, 1.0]
radius = [0.01, 0.02]
fill = 0.3
seed = 4
[[sample]]
kind = "lattice"
box = [0.4, 0.4, 0.6, 0.6]
radius = 0.03
"""


CLUMPS = """[[clump]]
name = "pair"
[[clump.shape]]
kind = "disk"
radius = 1.0
[[clump.shape]]
kind = "disk"
radius = 1.0
centre = [1.2, 0.0]
[[clump]]
name = "one"
[[clump.shape]]
kind = "disk"
radius = 1.0
"""
OF_CLUMPS = """[[sample]]
shape = "clump"
clump = CLUMP
box = [0.0, 0.0, 1.0, 1.0]
sieve = [[0.02, 0], [0.04, 100]]
count = 150
"""
FLOOR = """[[wall]]
from = [-0.2, -0.01]
to = [1.2, -0.01]
thickness = 0.02
"""
STONE = """v 0 0 0
v 3 0 0
v 0 2 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""
# A cube of which one corner is pushed in.
DENTED = """v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 0.4 0.4 0.4
v 0 1 1
f 1 4 3 2
f 1 2 6 5
f 1 5 8 4
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 5 6 7
f 5 7 8
"""


class Samples(ProgramCase):
    def run_deck(self, text, *words, code=0):
        (self.place / "deck.toml").write_text(text)
        return self.run_program("run", "deck.toml", "--output", "out", "--force", "--quiet", *words, code=code)

    def run_json(self):
        return json.loads((self.place / "out" / "run.json").read_text())

    def message(self, text):
        done = self.run_deck(text, code=2)
        return done.stdout + done.stderr

    def test_curves(self):
        """A named curve is that of the deck that writes it out; what sizes do not come from has no place in the effective deck."""
        if not self.has_library("Qhull"):
            self.skipTest("random polyhedra are hulls, which a program without Qhull cannot make")
        sieve = "sieve = [[0.0224, 0], [0.0315, 13], [0.04, 47.5], [0.05, 84.5], [0.063, 100]]"
        found = []
        for size in ('curve = "ballast_a"', sieve):
            self.run_deck(SCENE + SAMPLE.replace("SIZE", size + "\nelongation = [1.0, 2.0]"))
            run = self.run_json()
            found.append((run["mean_radius"], run["compactness"]))
            # A sphere about a grain is at least as large as its middle axis, and at most twice that.
            self.assertTrue(0.0112 < run["mean_radius"] < 0.063)
            effective = (self.place / "out" / "effective.toml").read_text()
            self.assertNotIn("distribution", effective)
            self.run_program("run", "out/effective.toml", "--output", "again", "--force", "--quiet")
        self.assertEqual(found[0], found[1])
        flat = self.message(SCENE + SAMPLE.replace("SIZE", sieve + "\nelongation = [1.0, 2.0]\nflatness = [1.0, 2.5]"))
        self.assertIn('"flatness" is at most "elongation"', flat)

    def test_cost_of_the_start(self):
        """What is reported as CPU time of steps and of the start is the CPU time of the process; each subdomain makes all stones, and
        waits for nothing, since all share one process."""
        if not self.has_library("Qhull"):
            self.skipTest("random polyhedra are hulls, which a program without Qhull cannot make")
        deck, start = SCENE + SAMPLE.replace("SIZE", 'curve = "ballast_a"').replace("150", "600"), {}
        for parts in (1, 6):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            self.run_deck(deck, "--set", f"partition.parts={parts}")
            after, run = resource.getrusage(resource.RUSAGE_CHILDREN), self.run_json()
            used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            start[parts] = run["start_cpu_seconds"]
            reported = start[parts] + run["cpu_seconds"]
            # Both clocks have a resolution of 10 ms at worst; loading the program and reading its keys is not in what is reported.
            self.assertLess(reported, used + 0.05)
            self.assertGreater(reported, 0.6 * used - 0.1)
        self.assertGreater(start[6], 3 * start[1])
        self.assertEqual([run["wait_seconds_mean"], run["wait_seconds_max"]], [0, 0])

    def test_stages_that_are_not_due_are_read_once(self):
        """A run that ends in the first of six stages: one subdomain reads the five others, so that six make the stones eleven times, and
        not 36 times."""
        if not self.has_library("Qhull"):
            self.skipTest("random polyhedra are hulls, which a program without Qhull cannot make")
        deck = SCENE + SAMPLE.replace("SIZE", 'curve = "ballast_a"').replace("150", "600")
        stages = "".join(f'[[stage]]\nname = "{name}"\nsteps = 1\n[[stage.law]]\nfriction = 0.{name}\n' for name in range(1, 7))
        start = {}
        for staged in ("", stages):
            self.run_deck(deck + staged, "--set", "partition.parts=6")
            start[staged] = self.run_json()["start_cpu_seconds"]
        # 11/6 = 1.8 times where each subdomain reads its own stage alone.
        self.assertLess(start[stages], 3.5 * start[""])

    def test_together(self):
        """Samples in one box do not overlap, in a periodic one neither: overlaps at the start are warned of."""
        for period in ("", "[scene]\nperiod_x = 1.0"):
            with self.subTest(period=period):
                done = self.run_deck(PLANE.replace("PERIOD", period) + FINE_AND_COARSE)
                self.assertNotIn("overlap", done.stdout + done.stderr)
                self.assertEqual(self.run_json()["volume_error"], 0.0)
                self.assertGreater(self.run_json()["grains"], 300)

    def test_refused(self):
        """What makes no sizes is refused with its place."""
        both = SAMPLE.replace("SIZE", 'radius = 0.02\ncurve = "ballast_a"')
        self.assertIn('needs one of the keys "radius", "sieve" and "curve"', self.message(SCENE + both))
        self.assertIn('needs one of the keys "radius", "sieve" and "curve"', self.message(SCENE + SAMPLE.replace("SIZE", "")))
        self.assertIn("openings must rise", self.message(SCENE + SAMPLE.replace("SIZE", "sieve = [[0.2, 0], [0.1, 100]]")))
        self.assertIn("a list of lists of 2 numbers", self.message(SCENE + SAMPLE.replace("SIZE", "sieve = [[0.2, 0, 1], [0.3, 100, 2]]")))
        full = PLANE.replace("PERIOD", "") + FINE_AND_COARSE.replace("fill = 0.3\nseed", "fill = 0.6\nseed")
        self.assertIn("next to those of other samples", self.message(full))

    def test_clumps(self):
        """A clump of one disk is a disk; clumps fall without overlap, and each grain is one body."""
        disks = OF_CLUMPS.replace('shape = "clump"\nclump = CLUMP\n', "")
        ones = CLUMPS + OF_CLUMPS.replace("CLUMP", '"one"')
        found = []
        for text in (disks, ones):
            done = self.run_deck(PLANE.replace("PERIOD", "") + text)
            run = self.run_json()
            found.append([run[key] for key in ("grains", "mean_radius", "compactness", "kinetic_energy")])
        self.assertIn('no [[sample]] uses the clump "pair"', done.stdout + done.stderr)
        # Radius and mass are those of the template times a factor: the same up to rounding.
        for disk, clump in zip(*found):
            self.assertAlmostEqual(clump / disk, 1.0, delta=1e-12)
        done = self.run_deck(PLANE.replace("PERIOD", "[scene]\nperiod_x = 1.0") + CLUMPS + OF_CLUMPS.replace("CLUMP", '["pair", "one"]'))
        self.assertNotIn("overlap", done.stdout + done.stderr)
        self.assertEqual(self.run_json()["grains"], 150)
        self.run_program("run", "out/effective.toml", "--output", "again", "--force", "--quiet")

    def test_grown(self):
        """Grown samples are as full as asked for, of disks, polygons and clumps, and next to other samples; too much is refused."""
        head = PLANE.replace("PERIOD", "[scene]\nperiod_x = 1.0")
        sample = '[[sample]]\nkind = "grown"\nbox = [0.0, 0.0, 1.0, 1.0]\nradius = [0.02, 0.03]\nfill = 0.78\n'
        for text in (sample, sample + 'shape = "polygon"\n', CLUMPS.replace('"one"', '"two"') + sample + 'shape = "clump"\nclump = ["pair", "two"]\n'):
            done = self.run_deck(head + text)
            self.assertNotIn("overlap", done.stdout + done.stderr)
            self.assertEqual(self.run_json()["volume_error"], 0.0)
        self.run_deck(head + sample)
        # Grains are added until their areas reach the fill: one of 428 more, and the height of the grains is at most that of the box.
        self.assertAlmostEqual(self.run_json()["compactness"], 0.78, delta=0.02)
        both = sample.replace("fill = 0.78", "fill = 0.4") + '[[sample]]\nkind = "lattice"\nbox = [0.3, 0.3, 0.7, 0.7]\nradius = 0.05\n'
        self.assertNotIn("overlap", self.run_deck(head + both).stderr)
        self.assertIn("do not grow to their size; a fill of 0.8 is about the most", self.message(head + sample.replace("0.78", "0.9")))

    def test_restart(self):
        """Clumps that fall: a restart goes on as the straight run, to the byte of the record but its times."""
        if not self.has_hdf5():
            self.skipTest("no HDF5")
        text = PLANE.replace("PERIOD", "").replace("steps = 1", "steps = 60").replace("1e-4", "2e-3") + CLUMPS
        text += OF_CLUMPS.replace("CLUMP", '["pair", "one"]') + FLOOR
        self.run_deck(text, "--set", "restart.every=40", "--set", "restart.at_end=false")
        self.assertGreater(self.run_json()["contacts"], 0)
        straight = self.record()
        self.run_deck(text, "--restart", "out/restart_a.h5")
        self.assertEqual(self.record(), straight)

    def record(self):
        """Rows of the record after step 40, without times that it took."""
        with (self.place / "out" / "record.csv").open(newline="") as file:
            rows = [row for row in csv.DictReader(file) if int(row["step"]) > 40]
        self.assertGreater(len(rows), 0)
        return [{name: value for name, value in row.items() if not re.search("seconds|^cpu_|^wall_", name)} for row in rows]

    def test_bad_clumps(self):
        """Clumps that are wrong are refused with their place."""
        head = PLANE.replace("PERIOD", "")
        sample = OF_CLUMPS.replace("CLUMP", '"pair"')
        self.assertIn('there is no clump named "pear"; did you mean "pair"?', self.message(head + CLUMPS + sample.replace("pair", "pear")))
        self.assertIn('there are two clumps named "one"', self.message(head + CLUMPS.replace("pair", "one") + sample.replace("pair", "one")))
        self.assertIn("this clump has no shape", self.message(head + '[[clump]]\nname = "pair"\n' + sample))
        self.assertIn('"clump"', self.message(head + CLUMPS + OF_CLUMPS.replace("clump = CLUMP\n", "")))
        self.assertIn('"kind" must be one of disk, polygon', self.message(head + CLUMPS.replace('"disk"', '"segment"', 1) + sample))

    def test_files(self):
        """Stones from files: all that match, at the sizes asked for; what is no convex stone is refused with the name of its file."""
        (self.place / "a.obj").write_text(STONE)
        (self.place / "b.OBJ").write_text(STONE.replace("0 2 0", "0 3 0"))
        (self.place / "dent.obj").write_text(DENTED)
        text = SCENE + SAMPLE.replace("SIZE", 'files = FILES\nsieve = [[0.02, 0], [0.03, 100]]').replace("150", "40")
        self.run_deck(text.replace("FILES", '["a.obj", "[b-c].*"]'))
        self.assertEqual(self.run_json()["grains"], 40)
        if self.has_library("Qhull"):
            self.run_deck(text.replace("FILES", '"dent.obj"\nhull = true'))
        dented = self.message(text.replace("FILES", '"*t.obj"'))
        self.assertIn("dent.obj: ", dented)
        self.assertIn("convex", dented)
        self.assertIn('no file matches "*.stl"', self.message(text.replace("FILES", '"*.stl"')))
        self.assertIn('"elongation" is refused next to "files"', self.message(text.replace("FILES", '"a.obj"\nelongation = 1.5')))


if __name__ == "__main__":
    take_program()
    unittest.main()
