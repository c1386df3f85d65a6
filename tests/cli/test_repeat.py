#!/usr/bin/env python3
"""A unit that is repeated, from outside: the same scene as the deck that writes all copies out, in the plane, in space and in stages."""

import csv
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

HEAD = """[scene]
dimension = 3
[time]
step = 1e-3
steps = 30
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.3
[[track]]
body = "*"
"""
CONTAINER = """[[container]]
name = "box"
size = [{length}, 0.4, 1.0]
"""
BODY = """[[body]]
name = "{name}"
shape = "sphere"
radius = 0.05
position = [{x}, 0.2, 0.05]
"""
CLUMP = """[[body]]
name = "{name}"
position = [{x}, 0.2, 0.3]
[[body.shape]]
kind = "sphere"
radius = 0.04
centre = [0.02, 0.0, 0.0]
[[body.shape]]
kind = "sphere"
radius = 0.04
centre = [-0.02, 0.0, 0.0]
"""
REGION = """[[region]]
name = "{name}"
box = [{x}, 0.0, 0.0, {end}, 0.4, 0.5]
"""
SAMPLE = """[[sample]]
box = [{x}, 0.0, 0.5, {end}, 0.4, 0.9]
radius = 0.03
count = 20
seed = {seed}
"""
REPEAT = "[repeat]\ncount = 3\nshift = [0.5, 0.0, 0.0]\n"


def unit(k):
    """The unit number k from 0, written out."""
    x, end = 0.5 * k, 0.5 * k + 0.5
    name = f".{k + 1}" if k else ""
    return [BODY.format(name="ball" + name, x=x + 0.2), CLUMP.format(name="pair" + name, x=x + 0.2),
            REGION.format(name="low" + name, x=x, end=end), SAMPLE.format(x=x, end=end, seed=5 + 7919 * k)]


def written_out(count=3):
    """Blocks of all units, kind by kind, behind a container as long as they."""
    return CONTAINER.format(length=0.5 * count) + "".join("".join(blocks) for blocks in zip(*map(unit, range(count)), strict=True))


class Repeat(ProgramCase):
    def rows(self, output, file, key):
        """Rows of a file by step and name."""
        with (self.place / output / file).open(newline="") as text:
            return {(row["step"], row[key]): row for row in csv.DictReader(text)}

    def test_as_written_out(self):
        """Bodies with their shapes, regions, samples and a container: the very same numbers, in stages too."""
        stages = '[[stage]]\nsteps = 20\n[[stage]]\nsteps = 10\n[[stage.drive]]\nbody = "ball*"\ncomponent = "x"\nvalue = 0.1\n'
        once = CONTAINER.format(length=0.5) + "".join(unit(0))
        for more in ("", stages) if self.has_hdf5() else ("",):
            with self.subTest(more=more):
                self.run_deck(HEAD + REPEAT + more + once)
                self.run_deck(HEAD + more + written_out(), output="long")
                for file, key in (("tracks.csv", "body"), ("regions.csv", "region")):
                    long = self.rows("long", file, key)
                    self.assertGreater(len(long), 8)
                    self.assertEqual(self.rows("out", file, key).keys(), long.keys())
                # Bodies have another order, which rounding may show.
                for place, row in self.rows("out", "tracks.csv", "body").items():
                    for name in ("x", "y", "z"):
                        self.assertAlmostEqual(float(row[name]), float(self.rows("long", "tracks.csv", "body")[place][name]), delta=1e-6)
        self.run_deck(HEAD + REPEAT + once, "--set", "repeat.count=1")
        self.run_deck(HEAD + once, output="single")
        self.assertEqual((self.place / "out" / "tracks.csv").read_bytes(), (self.place / "single" / "tracks.csv").read_bytes())

    def test_effective(self):
        """The effective deck holds the unit and how often it stands there: it gives the same run."""
        self.run_deck(HEAD + REPEAT + CONTAINER.format(length=0.5) + "".join(unit(0)))
        text = (self.place / "out" / "effective.toml").read_text()
        self.assertEqual(text.count("[[body]]"), 2)
        self.run_deck(text, output="again")
        self.assertEqual((self.place / "out" / "tracks.csv").read_bytes(), (self.place / "again" / "tracks.csv").read_bytes())

    def test_ranks(self):
        """Several ranks share the copies."""
        if not self.launcher:
            self.skipTest("no MPI")
        files = []
        for ranks in (1, 2):
            self.on_ranks(ranks, HEAD + REPEAT + CONTAINER.format(length=0.5) + "".join(unit(0)), f"r{ranks}", "--set", "partition.parts=2")
            files.append((self.place / f"r{ranks}" / "tracks.csv").read_bytes())
        self.assertEqual(*files)

    def test_mistakes(self):
        """No shift, next to a DATBOX, units into each other: one sentence."""
        once = CONTAINER.format(length=0.5) + "".join(unit(0))
        said = self.run_deck(HEAD + "[repeat]\ncount = 2\n" + once, code=2).stderr
        self.assertIn('what is repeated needs a "shift"', said)
        self.assertRegex(said, r"deck\.toml:14:9: error: ")
        self.run_deck(HEAD + once)
        self.run_program("convert", "deck.toml", "box")
        text = '[scene]\ndatbox = "box"\n[time]\nstep = 1e-3\nsteps = 1\n' + REPEAT
        self.assertIn("a DATBOX cannot be repeated", self.run_deck(text, code=2).stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
