#!/usr/bin/env python3
"""Scenes of the talk, small: their decks run, and what they measure has the size that mechanics asks for."""

import csv
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

DECKS = Path(__file__).resolve().parents[2] / "input_decks/talk"


class TalkScenes(ProgramCase):
    def rows_of(self, name, **wanted):
        """Rows of a file of results, as numbers, where columns have the values wanted."""
        with open(self.place / "out" / name, newline="") as file:
            rows = [row for row in csv.DictReader(file) if all(row[key] == value for key, value in wanted.items())]
        return [{key: value if key == "body" else float(value) for key, value in row.items()} for row in rows]

    def test_a_wall_that_shortens_a_sandbox_pushes_a_wedge(self):
        """394 grains: the wall does work, the sand resists by more than its friction on the base, and weighs what it did."""
        if not self.has_hdf5():
            self.skipTest("no HDF5")
        deck = self.place / "sandbox.toml"
        deck.write_text((DECKS / "sandbox.toml").read_text().replace("radius = 2.4e-3", "radius = 6e-3"))
        self.run_program("run", deck, "--output", "out", "--set", "time.steps=1200", "--set", "partition.parts=2", "--quiet")
        run = json.loads((self.place / "out/run.json").read_text())
        self.assertEqual(run["steps"], 1200)
        pushed = self.rows_of("tracks.csv", body="wall.push", stage="2")
        base = self.rows_of("tracks.csv", body="wall.base", stage="2")
        self.assertAlmostEqual(pushed[-1]["displacement"], 0.1 * (pushed[-1]["time"] - pushed[0]["time"]), delta=0.01)
        late = slice(len(pushed) // 2, None)
        force = -sum(row["mean_force_x"] for row in pushed[late])
        weight = -sum(row["mean_force_y"] for row in base[late])
        self.assertGreater(force, 0.05 * weight)
        self.assertLess(force, 2 * weight)
        self.assertGreater(run["splits"], 3)


if __name__ == "__main__":
    take_program()
    unittest.main()
