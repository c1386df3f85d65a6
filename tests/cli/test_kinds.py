#!/usr/bin/env python3
"""Coordination by kind of body, from outside: closed forms at rest, scenes of one kind, restarts to the last digit, several ranks, a
DATBOX, end conditions."""

import csv
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

START = """[scene]
dimension = {dimension}
[time]
step = 1e-3
steps = {steps}
[solver]
criterion = "e8"
tolerance = {tolerance}
[output]
record_every = 10
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.3
"""
FLOOR = '[[wall]]\nname = "floor"\nfrom = [-1.0, -0.05]\nto = [2.0, -0.05]\nthickness = 0.1\n'
SIDES = ('[[wall]]\nfrom = [-0.05, -0.1]\nto = [-0.05, 0.9]\nthickness = 0.1\n'
         '[[wall]]\nfrom = [0.65, -0.1]\nto = [0.65, 0.9]\nthickness = 0.1\n')
SQUARE = '[[body]]\nshape = "polygon"\nvertices = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]\nposition = [0.0, 0.1]\n'
PEANUT = ('[[clump]]\nname = "peanut"\n' + "".join(f'[[clump.shape]]\nkind = "disk"\nradius = 1.0\ncentre = [{x}, 0.0]\n' for x in (-0.7, 0.7)))
KINDS = ("coordination_disk", "coordination_polygon", "coordination_clump")


def start(dimension=2, steps=50, tolerance=1e-12):
    return START.format(dimension=dimension, steps=steps, tolerance=tolerance)


def disk(x, y):
    return f'[[body]]\nshape = "disk"\nradius = 0.05\nposition = [{x}, {y}]\n'


def mixed(steps=400):
    """Disks, polygons and peanuts that fall into a box."""
    sample = '[[sample]]\nkind = "random"\n{}\nbox = [0.0, {}, 0.6, {}]\ncount = 15\n'
    return (start(steps=steps, tolerance=1e-6) + FLOOR + SIDES + PEANUT
            + sample.format('radius = [0.02, 0.03]', 0.0, 0.15)
            + sample.format('shape = "polygon"\nradius = [0.02, 0.03]', 0.15, 0.3)
            + sample.format('shape = "clump"\nclump = ["peanut"]\nradius = [0.01, 0.02]', 0.3, 0.5))


class Kinds(ProgramCase):
    def record(self, output="out"):
        """Rows without what clocks count."""
        with (self.place / output / "record.csv").open(newline="") as file:
            return [{name: float(value) for name, value in row.items() if not name.startswith(("cpu", "wall_"))}
                    for row in csv.DictReader(file)]

    def test_plane(self):
        """Two disks and a square on a floor, a third disk on the square: each disk has one neighbour, the square two."""
        self.run_deck(start() + FLOOR + disk(-0.5, 0.05) + disk(0.5, 0.05) + SQUARE + disk(0.0, 0.25))
        row = self.record()[-1]
        self.assertEqual([row[name] for name in KINDS[:2]], [1.0, 2.0])
        self.assertEqual(row["coordination"], 5 / 4)
        self.assertNotIn(KINDS[2], row)

    def test_clumps(self):
        """A peanut on a floor with a disk on each of its ends: three neighbours, though four contacts."""
        peanut = ('[[body]]\nposition = [0.0, 0.05]\n' + "".join(
            f'[[body.shape]]\nkind = "disk"\nradius = 0.05\ncentre = [{x}, 0.0]\n' for x in (-0.1, 0.1)))
        self.run_deck(start() + FLOOR + peanut + disk(-0.1, 0.15) + disk(0.1, 0.15))
        row = self.record()[-1]
        self.assertEqual([row[KINDS[0]], row[KINDS[2]]], [1.0, 3.0])
        self.assertEqual([row["double_contacts"], row["single_contacts"]], [1.0, 2.0])

    def test_space(self):
        """A ball on a floor, and one on a cube."""
        text = ('[[wall]]\ncentre = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nsize = [6.0, 6.0]\nthickness = 0.1\n'
                '[[body]]\nshape = "box"\nhalf_axes = [0.1, 0.1, 0.1]\nposition = [0.0, 0.0, 0.1]\n')
        text += "".join(f'[[body]]\nshape = "sphere"\nradius = 0.05\nposition = [{x}, 0.0, {z}]\n' for x, z in ((0.5, 0.05), (0.0, 0.25)))
        self.run_deck(start(3) + text)
        row = self.record()[-1]
        self.assertEqual([row["coordination_sphere"], row["coordination_polyhedron"]], [1.0, 2.0])

    def test_one_kind(self):
        """Disks among segments are one kind: no columns; an end condition that names one is refused before the first step."""
        text = start() + FLOOR + disk(0.0, 0.05)
        self.run_deck(text)
        self.assertEqual([name for name in self.record()[0] if name.startswith("coordination")],
                         ["coordination", "coordination_without_rattlers"])
        done = self.run_deck(text + '[stop]\nwhen = "coordination_disk > 0.5"\n', "--force", code=2)
        self.assertIn('there is no "coordination_disk" here', done.stderr)

    def test_end_condition(self):
        """A run ends when its disks have met the floor."""
        self.run_deck(start(steps=500) + FLOOR + disk(-0.5, 0.1) + SQUARE + '[stop]\nwhen = "coordination_disk > 0.5"\n')
        # A fall by 0.05 m takes 0.101 s: recorded every 10 steps, the 11th row is the first with a contact.
        self.assertEqual(self.record()[-1]["step"], 110)

    def test_restart(self):
        """A run that goes on from a checkpoint has the very same record; of 15 grains of each kind the mean is that of all."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        words = ("--set", "restart.every=150", "--set", "restart.at_end=false")
        self.run_deck(mixed(), *words)
        straight = self.record()
        for row in straight:
            # A few roundings of numbers below ten.
            self.assertAlmostEqual(sum(row[name] for name in KINDS) / 3, row["coordination"], delta=1e-14)
        self.assertGreater(min(straight[-1][name] for name in KINDS), 1.0)
        self.run_deck(mixed(), *words, "--restart", "out/restart_a.h5")
        self.assertEqual(self.record(), straight)

    def test_datbox(self):
        """The same scene from a DATBOX has the same columns."""
        text = FLOOR + disk(-0.5, 0.05) + disk(0.5, 0.05) + SQUARE + disk(0.0, 0.25)
        (self.place / "first.toml").write_text(start() + text)
        self.run_program("convert", "first.toml", "DATBOX")
        self.run_deck('[scene]\ndatbox = "DATBOX"\n[time]\nstep = 1e-3\nsteps = 20\n[output]\nrecord_every = 10\n')
        self.assertEqual([self.record()[-1][name] for name in KINDS[:2]], [1.0, 2.0])

    def test_ranks(self):
        """The same subdomains on one rank and on three: the same numbers."""
        if not self.launcher:
            self.skipTest("no MPI")
        found = []
        for ranks in (1, 3):
            self.on_ranks(ranks, mixed(100), f"parts{ranks}", "--set", "partition.parts=3")
            found.append(self.record(f"parts{ranks}"))
        self.assertEqual(*found)


if __name__ == "__main__":
    take_program()
    unittest.main()
