#!/usr/bin/env python3
"""Contacts that are kept while their pair hardly moves, from outside: a restart changes nothing, in the plane and in space, with
periods, bonds, composite bodies and substeps, on one rank and on two; overlap and energies stay what they are without."""

import json
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

#: Decks, the steps of a run, and settings: polygons on walls, periodic ones, bonds, polyhedra, blocks with substeps
CASES = (
    (ROOT / "input_decks" / "polygons_settling.toml", 60, ()),
    (ROOT / "tests" / "decks" / "periodic_polygons" / "deck.toml", 60, ()),
    (ROOT / "tests" / "decks" / "stones_on_a_slope" / "deck.toml", 60, ()),
    (ROOT / "input_decks" / "cracking_wall.toml", 30, ()),
    (ROOT / "input_decks" / "polyhedra_settling.toml", 60, ("solver.maximum_sweeps=20",)),
    (ROOT / "input_decks" / "brick_wall.toml", 20, ("time.substeps=2", "solver.maximum_sweeps=20")),
)


class KeptContacts(ProgramCase):
    def run_deck(self, deck, output, steps, settings, *words):
        settings = ["scene.kept_motion=1e-3", f"time.steps={steps}", "output.record_every=1", "output.every=0", *settings]
        flags = [word for setting in settings for word in ("--set", setting)]
        return self.run_program("run", str(deck), "--output", output, "--quiet", *flags, *words)

    def test_restart(self):
        """A run that is interrupted goes on to the same numbers, digit by digit, from contacts that it keeps."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        for deck, steps, settings in CASES:
            with self.subTest(deck=deck.parent.name + "/" + deck.name):
                self.run_deck(deck, "straight", steps, settings, "--force")
                self.run_deck(deck, "parts", 2 * steps // 3, settings, "--force")
                self.run_deck(deck, "parts", steps, settings, "--restart", "parts")
                self.assertEqual(len(self.rows("straight")), steps)
                self.assertEqual(self.rows("straight"), self.rows("parts"))

    def test_off(self):
        """A checkpoint of contacts that are kept goes on without, and one without them with."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        deck = CASES[0][0]
        for first, then in ((1e-3, 0.0), (0.0, 1e-3)):
            self.run_deck(deck, "out", 20, [f"scene.kept_motion={first}"], "--force")
            self.run_deck(deck, "out", 40, [f"scene.kept_motion={then}"], "--restart", "out")
            self.assertEqual(len(self.rows("out")), 40)

    def test_rest(self):
        """Grains that come to rest overlap no more than without: half as much again at most, as two such runs scatter by a third."""
        overlap = {}
        for kept in ("0", "1e-3"):
            self.run_deck(CASES[0][0], "out", 400, [f"scene.kept_motion={kept}"], "--force")
            rows = self.rows("out")
            overlap[kept] = max(float(row["mean_penetration"]) for row in rows[len(rows) // 2:])
            self.assertLess(json.loads((self.place / "out" / "run.json").read_text())["energy_closure"], 1e-10)
        self.assertLess(overlap["1e-3"], 1.5 * overlap["0"])

    def test_log(self):
        """The plan shows by how much gaps may be off, and only where contacts are kept."""
        words = ["run", str(CASES[0][0]), "--output", "out", "--force", "--set", "time.steps=1", "--set", "output.every=0"]
        self.assertRegex(self.run_program(*words, "--set", "scene.kept_motion=1e-3").stdout, r"kept +contacts .* 2\.00E-03")
        self.assertNotIn("\nkept ", self.run_program(*words, "--set", "scene.kept_motion=0").stdout)

    def test_refused(self):
        """Shares that are none."""
        for value in ("-1e-3", "0.2"):
            done = self.run_program("run", str(CASES[0][0]), "--output", "out", "--set", f"scene.kept_motion={value}", code=2)
            self.assertIn("kept_motion", done.stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
