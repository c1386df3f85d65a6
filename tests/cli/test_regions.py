#!/usr/bin/env python3
"""Regions from outside: closed forms of shapes that the box cuts, a box about the whole scene against the record, parts that add up,
restarts to the byte, several ranks, and boxes that make no sense."""

import csv
import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from beds import bed  # noqa: E402
from program_case import ProgramCase, take_program  # noqa: E402

SPACE = "[scene]\ndimension = 3\n"
START = """[time]
step = 1e-3
steps = {steps}
[output]
record_every = {every}
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.3
"""
BED, PLANE_BED = bed(3, "sphere", [0.03, 0.04]), bed(2, "polygon", [0.03, 0.04])
RECORDED = ("volume_error", "coordination", "mean_velocity", "max_velocity", "shear_rate", "single_contacts", "double_contacts",
            "triple_contacts")


def start(steps=60, every=10):
    return START.format(steps=steps, every=every)


def region(name, *box):
    """A region as a block of a deck."""
    return f'[[region]]\nname = "{name}"\nbox = {list(map(float, box))}\n'


def ball(x, y, z, radius=0.1, more=""):
    return f'[[body]]\nshape = "sphere"\nradius = {radius}\nposition = [{x}, {y}, {z}]\n{more}'


class Regions(ProgramCase):
    def rows(self, name=None, output="out", file="regions.csv"):
        """Rows of a region, or of all, with numbers for words."""
        with (self.place / output / file).open(newline="") as text:
            rows = [{key: value if key == "region" else float(value) for key, value in row.items()
                     if value not in ("T", "F")} for row in csv.DictReader(text)]
        return [row for row in rows if name in (None, row.get("region"))]

    def test_cut_shapes(self):
        """Shapes that the box cuts at their middles; a fixed body takes its volume from the room; what is outside does not count."""
        still = "fixed = true\n"
        cube = '[[body]]\nshape = "box"\nhalf_axes = [0.1, 0.1, 0.1]\nposition = [1.0, 0.01, 0.5]\n'
        text = SPACE + "gravity = [0.0, 0.0, 0.0]\n" + start(1, 1) + ball(0, 0, 0) + ball(3, 0, 0) + cube \
            + ball(0, 0, 0.5, 0.2, still) + region("all", 0, 0, 0, 2, 1, 1) + region("side", 2, 0, 0, 3, 1, 1)
        self.run_deck(text)
        row = self.rows("all")[0]
        grains = 4 / 3 * math.pi * 0.1**3 / 8 + 0.2 * 0.11 * 0.2
        self.assertAlmostEqual(row["compactness"], grains / (2 - 4 / 3 * math.pi * 0.2**3 / 4), delta=1e-12)
        # Centres on the least sides of a box are within.
        self.assertEqual(row["grains"], 2)
        other = self.rows("side")[0]
        self.assertAlmostEqual(other["compactness"], 4 / 3 * math.pi * 0.1**3 / 8, delta=1e-12)
        self.assertEqual((other["grains"], other["coordination"], other["inertia_number"]), (0, 0, 0))

    def test_cut_shapes_in_the_plane(self):
        """Half a disk and half a square; a periodic border does not part a box."""
        text = "[scene]\ngravity = [0.0, 0.0]\nperiod_x = 2.0\n" + start(1, 1) + \
            '[[body]]\nshape = "disk"\nradius = 0.1\nposition = [1.95, 0.5]\n' \
            '[[body]]\nshape = "polygon"\nvertices = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]\nposition = [0.5, 0.0]\n' \
            + region("across", 1.8, 0.5, 2.2, 1.0) + region("low", 0, 0, 1, 1)
        self.run_deck(text)
        self.assertAlmostEqual(self.rows("across")[0]["compactness"], math.pi * 0.01 / 2 / 0.2, delta=1e-12)
        low = self.rows("low")[0]
        right = self.segment(0.1, 0.05)
        self.assertAlmostEqual(low["compactness"], 0.02 + right, delta=1e-12)

    @staticmethod
    def segment(radius, distance):
        """Area of a disk beyond a line at this distance from its centre."""
        return radius**2 * math.acos(distance / radius) - distance * math.sqrt(radius**2 - distance**2)

    def test_whole_scene(self):
        """A box about all grains has the indicators of the record; its compactness is their volume over that of the box."""
        for bed, box, first in ((SPACE + start(240, 40) + BED, (-0.1, -0.1, -0.1, 0.7, 0.4, 0.9), 80),
                                (start(240, 40) + PLANE_BED, (-0.1, -0.1, 1.1, 0.9), 50)):
            with self.subTest(box=box):
                self.run_deck(bed + region("all", *box), "--force")
                record = self.rows(file="record.csv")
                self.assertGreater(record[-1]["coordination"], 0.5)
                for mine, whole in zip(self.rows("all"), record, strict=True):
                    self.assertGreater(mine["grains"], first)
                    for name in RECORDED:
                        self.assertAlmostEqual(mine[name], whole[name], delta=1e-9 * max(1, abs(whole[name])), msg=name)
                    if whole["pressure"] > 0 and mine["pressure"] > 0:
                        # The same sum of force times branch, over another volume.
                        room = mine["compactness"] / whole["compactness"]
                        self.assertAlmostEqual(mine["pressure"] / whole["pressure"], room, delta=1e-6)
                        self.assertAlmostEqual(mine["inertia_number"] / whole["inertia_number"], room**-0.5, delta=1e-6)

    def test_halves(self):
        """Two halves: grains add up, volumes by the share of the box."""
        self.run_deck(SPACE + start() + BED + region("all", 0, 0, 0, 0.6, 0.3, 0.3) + region("left", 0, 0, 0, 0.25, 0.3, 0.3)
                      + region("right", 0.25, 0, 0, 0.6, 0.3, 0.3))
        for whole, left, right in zip(self.rows("all"), self.rows("left"), self.rows("right"), strict=True):
            self.assertEqual(whole["grains"], left["grains"] + right["grains"])
            self.assertAlmostEqual(whole["compactness"] * 0.6, left["compactness"] * 0.25 + right["compactness"] * 0.35, delta=1e-12)
            self.assertAlmostEqual(whole["pressure"] * 0.6, left["pressure"] * 0.25 + right["pressure"] * 0.35,
                                   delta=1e-9 * whole["pressure"] + 1e-9)

    def test_restart(self):
        """A run that goes on from a checkpoint writes the very same file; so does one in stages, with their number."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        text = start(60, 7) + PLANE_BED + region("low", 0, 0, 1, 0.2)
        words = ("--set", "restart.every=25", "--set", "restart.at_end=false")
        self.run_deck(text, *words)
        straight = (self.place / "out" / "regions.csv").read_bytes()
        self.run_deck(text, *words, "--restart", "out/restart_a.h5")
        self.assertEqual((self.place / "out" / "regions.csv").read_bytes(), straight)
        self.assertEqual(json.loads((self.place / "out" / "run.json").read_text())["file_regions"], "regions.csv")
        self.run_deck(text + "[[stage]]\nsteps = 30\n[[stage]]\nsteps = 30\n", output="stages")
        self.assertEqual([row["stage"] for row in self.rows(output="stages")], [1] * 5 + [2] * 5)

    def test_ranks(self):
        """The same bytes where the subdomains are the same, and the record of several ranks."""
        if not self.launcher:
            self.skipTest("no MPI")
        text = SPACE + start(40, 10) + BED + region("all", -0.1, -0.1, -0.1, 0.7, 0.4, 0.9) + region("low", 0.1, 0, 0, 0.4, 0.3, 0.2)
        texts = []
        for ranks in (1, 3):
            self.on_ranks(ranks, text, f"parts{ranks}", "--set", "partition.parts=3")
            texts.append((self.place / f"parts{ranks}" / "regions.csv").read_bytes())
        self.assertEqual(*texts)
        for mine, whole in zip(self.rows("all", "parts3"), self.rows(output="parts3", file="record.csv"), strict=True):
            for name in RECORDED:
                self.assertAlmostEqual(mine[name], whole[name], delta=1e-9 * max(1, abs(whole[name])), msg=name)

    def test_mistakes(self):
        """Boxes and names that make no sense: sentence and place. Without regions there is no file."""
        text = start(1, 1) + PLANE_BED
        for block, sentence in ((region("a", 0, 0, 1, 0), "a box is given by its least, then its largest coordinates"),
                                (region("a", 0, 0, 1, 1) * 2, 'two regions have the name "a"')):
            self.assertIn(sentence, self.run_deck(text + block, code=2).stderr)
        done = self.run_deck(text + region("a", 0, 0, 1, 1), "--force", "--set", "output.record_every=0")
        self.assertIn("[[region]] has no effect with output.record_every = 0", done.stderr)
        self.run_deck(text, "--force")
        self.assertFalse((self.place / "out" / "regions.csv").exists())


if __name__ == "__main__":
    take_program()
    unittest.main()
