#!/usr/bin/env python3
"""Means per subdomain from outside: the record of an undivided scene, parts that add up to it, the gradient of an affine motion,
restarts to the byte, several ranks."""

import csv
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from beds import bed  # noqa: E402
from program_case import ProgramCase, take_program  # noqa: E402

DECK = """[scene]
dimension = {dimension}
[time]
step = 1e-3
steps = 240
[output]
record_every = 40
subdomain_means = true
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.3
"""
# Grains of one size, so that the volume of a subdomain's grains follows from their number.
PLANE = DECK.format(dimension=2) + bed(2, "disk", 0.035)
SPACE = DECK.format(dimension=3) + bed(3, "sphere", 0.035)
AXES = {PLANE: "xy", SPACE: "xyz"}


class SubdomainMeans(ProgramCase):
    def rows(self, output="out", file="subdomains.csv"):
        """Rows of a file, numbers for words."""
        with (self.place / output / file).open(newline="") as text:
            return [{key: float(value) for key, value in row.items() if value not in ("T", "F")} for row in csv.DictReader(text)]

    def close(self, mine, whole, name):
        self.assertAlmostEqual(mine, whole, delta=1e-9 * max(1, abs(whole)), msg=name)

    def test_undivided(self):
        """One subdomain has compactness and fabric of the record, and its stress over the compactness."""
        for deck, axes in AXES.items():
            with self.subTest(axes=axes):
                self.run_deck(deck, "--force")
                for mine, whole in zip(self.rows(), self.rows(file="record.csv"), strict=True):
                    self.assertEqual(mine["subdomain"], 0)
                    self.close(mine["compactness"], whole["compactness"], "compactness")
                    for a in axes:
                        for b in axes:
                            self.close(mine[f"grain_stress_{a}{b}"] * mine["compactness"], whole[f"stress_{a}{b}"], a + b)
                            if a <= b:
                                self.close(mine[f"fabric_{a}{b}"], whole[f"fabric_{a}{b}"], a + b)
                self.assertGreater(mine["contacts"], 50)
                self.assertGreater(mine["grain_stress_" + 2 * axes[-1]], 100.0)

    def test_parts_add_up(self):
        """Grains of all subdomains, and means weighed by grains and contacts, are those of the scene, by either gluing."""
        for deck, axes in AXES.items():
            for gluing in ("dual", "primal"):
                with self.subTest(axes=axes, gluing=gluing):
                    self.run_deck(deck, "--force", "--set", "partition.parts=4", "--set", f'partition.gluing="{gluing}"')
                    self.add_up(axes)

    def add_up(self, axes):
        rows = self.rows()
        for whole in self.rows(file="record.csv"):
            parts = [row for row in rows if row["step"] == whole["step"]]
            self.assertEqual([row["subdomain"] for row in parts], [0, 1, 2, 3])
            grains, contacts = (sum(row[name] for row in parts) for name in ("grains", "contacts"))
            self.assertGreater(grains, 70)
            for a in axes:
                for b in axes:
                    stress = sum(row["grains"] * row[f"grain_stress_{a}{b}"] for row in parts) / grains
                    self.close(stress * whole["compactness"], whole[f"stress_{a}{b}"], a + b)
                    if a <= b and contacts:
                        fabric = sum(row["contacts"] * row[f"fabric_{a}{b}"] for row in parts) / contacts
                        self.close(fabric, whole[f"fabric_{a}{b}"], a + b)
        self.assertGreater(contacts, 50)

    def test_affine_motion(self):
        """Grains whose velocities are L x, without contacts: each subdomain finds L, whichever grains it owns."""
        motion = ((0.3, -0.7), (0.2, 0.5))
        text = "[scene]\ngravity = [0.0, 0.0]\n[time]\nstep = 1e-3\nsteps = 1\n[output]\nrecord_every = 1\n" \
            'subdomain_means = true\n[[material]]\nname = "stone"\ndensity = 2500.0\n[[law]]\nfriction = 0.3\n'
        for i in range(6):
            for j in range(4):
                x, y = i + 0.1 * j, j - 0.05 * i**2
                u, v = (row[0] * x + row[1] * y for row in motion)
                text += f'[[body]]\nshape = "disk"\nradius = 0.1\nposition = [{x}, {y}]\nvelocity = [{u}, {v}]\n'
        self.run_deck(text, "--set", "partition.parts=2")
        rows = self.rows()
        self.assertEqual(sum(row["grains"] for row in rows), 24)
        # Velocities are those of the start, positions those of the end of the step: L (1 + h L)^-1.
        h = 1e-3
        (a, b), (c, d) = ((1 + h * motion[0][0], h * motion[0][1]), (h * motion[1][0], 1 + h * motion[1][1]))
        inverse = ((d, -b), (-c, a))
        for row in rows:
            for i, u in enumerate("xy"):
                for j, v in enumerate("xy"):
                    exact = sum(motion[i][k] * inverse[k][j] for k in (0, 1)) / (a * d - b * c)
                    self.assertAlmostEqual(row[f"velocity_gradient_{u}{v}"], exact, delta=1e-12)

    def test_restart(self):
        """A run that goes on from a checkpoint writes the very same file; without the key there is none."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        words = ("--set", "restart.every=100", "--set", "restart.at_end=false", "--set", "partition.parts=2")
        self.run_deck(PLANE, *words)
        straight = (self.place / "out" / "subdomains.csv").read_bytes()
        self.run_deck(PLANE, *words, "--restart", "out/restart_a.h5")
        self.assertEqual((self.place / "out" / "subdomains.csv").read_bytes(), straight)
        self.run_deck(PLANE, "--set", "output.subdomain_means=false", "--force")
        self.assertFalse((self.place / "out" / "subdomains.csv").exists())
        done = self.run_deck(PLANE, "--set", "output.record_every=0", "--force")
        self.assertIn("output.subdomain_means has no effect with output.record_every = 0", done.stderr)

    def test_ranks(self):
        """The same bytes where the subdomains are the same."""
        if not self.launcher:
            self.skipTest("no MPI")
        texts = []
        for ranks in (1, 3):
            self.on_ranks(ranks, SPACE, f"parts{ranks}", "--set", "partition.parts=3")
            texts.append((self.place / f"parts{ranks}" / "subdomains.csv").read_bytes())
        self.assertEqual(*texts)


if __name__ == "__main__":
    take_program()
    unittest.main()
