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

    def write_small(self, name):
        """Write a biaxial test of larger grains, a third as many, which fill 0.78 of the box: they grow four times as fast as to 0.8."""
        deck = (DECKS / name).read_text()
        for key, old, new in (("radius", "[7e-3, 10.5e-3]", "[0.012, 0.018]"), ("fill", "0.8", "0.78")):
            self.assertEqual(deck.count(f"\n{key} = {old}\n"), 1)
            deck = deck.replace(f"\n{key} = {old}\n", f"\n{key} = {new}\n")
        (self.place / "deck.toml").write_text(deck)

    def membrane(self, *words):
        """Consolidate a sample between its membranes; returns run.json."""
        self.write_small("membrane_biaxial.toml")
        self.run_program("run", "deck.toml", "--output", "out", "--force", "--quiet", "--set", "time.steps=800", *words)
        return json.loads((self.place / "out/run.json").read_text())

    def test_membranes_confine_a_sample(self):
        """At rest, under one pressure all round, the force on the platens is that pressure over the width between the membranes."""
        if not self.has_hdf5():
            self.skipTest("no HDF5")
        for words in ((), ("--set", "partition.parts=2")):
            self.membrane(*words)
            force = self.rows_of("tracks.csv", body="top", stage="1")[-1]["mean_force_y"]
            self.assertAlmostEqual(force, 0.3 * 1e4, delta=0.02 * 0.3 * 1e4)
            last = self.rows_of("tracks.csv", body="left.38", stage="1")[-1]
            # The membrane is pushed by half of the pressure on two segments of 8 mm each, and held by grains and wires.
            self.assertAlmostEqual(last["mean_force_x"], -1e4 * 8e-3, delta=0.5 * 1e4 * 8e-3)

    def test_rigid_walls_press_a_sample_and_then_deform_it(self):
        """At rest the forces on two free walls are the pressure over their free lengths; then the lateral one alone stays so. The second
        stage from the checkpoint of the first, by --restart, is that of one run, digit by digit."""
        if not self.has_hdf5():
            self.skipTest("no HDF5")
        self.write_small("walls_biaxial.toml")
        shortened = ("--set", "stage[2].duration=0.2", "--quiet")
        self.run_program("run", "deck.toml", "--output", "out", *shortened)
        tracked = {(body, stage): self.rows_of("tracks.csv", body=body, stage=stage) for body in ("top", "right") for stage in "12"}
        top, right = tracked["top", "1"][-1], tracked["right", "1"][-1]
        width, height = right["x"] - 0.01, top["y"] - 0.01
        # The stage ends with speeds of 1e-3 m/s at most: what is left of the inertia of walls and grains is far below 2 %.
        self.assertAlmostEqual(top["mean_force_y"] / width, 1e4, delta=200)
        self.assertAlmostEqual(right["mean_force_x"] / height, 1e4, delta=200)
        last = slice(len(tracked["right", "2"]) // 2, None)
        mean = sum(row["mean_force_x"] for row in tracked["right", "2"][last]) / len(tracked["right", "2"][last])
        self.assertAlmostEqual(mean / height, 1e4, delta=500)
        self.assertGreater(tracked["top", "2"][-1]["mean_force_y"] / width, 1.3e4)
        self.run_program("run", "deck.toml", "--output", "first", "--set", "stage[2].duration=5e-4", "--quiet")
        self.run_program("run", "deck.toml", "--restart", "first", "--output", "out", "--force", *shortened)
        self.assertEqual(self.rows_of("tracks.csv", body="top", stage="2")[-1], tracked["top", "2"][-1])

    def test_a_pressure_on_a_chain_is_refused_with_one_sentence(self):
        self.write_small("membrane_biaxial.toml")
        deck = (self.place / "deck.toml").read_text()
        for old, new, sentence in (
            ('body = "left.*"\nchain = "open"', 'body = "left.1"\nchain = "open"', "an open chain needs two bodies or more"),
            ('body = "left.*"\nchain = "open"', 'body = "left.*"\nlength = 0.1\nchain = "open"', 'a pressure on a chain has no "length"'),
            ('body = "left.*"\nchain = "open"', 'body = "left.*"\nlength = 0.1', 'a pressure needs the key "direction", or "chain"'),
            ("[scene]\n", "[scene]\nperiod_x = 2.0\n", "a pressure on a chain does not work in periodic scenes"),
        ):
            (self.place / "deck.toml").write_text(deck.replace(old, new, 1))
            self.assertIn(sentence, self.run_program("check", "deck.toml", code=2).stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
