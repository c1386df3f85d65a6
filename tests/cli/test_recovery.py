#!/usr/bin/env python3
"""Overlap that is undone, from outside: what rests stays as it is, a restart changes nothing, subdomains gain as one does, and decks
whose laws need overlap are refused."""

import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402
from ranks_case import COMMON, FLOOR, PRESSED, SIDES, grains  # noqa: E402

# Two equal disks, 2.5 % of their radius deep in each other, the second of which is tied to a post.
TIED = """[scene]
gravity = [0.0, 0.0]
[time]
step = 1e-3
steps = 8
recovery = 1e-6
recovery_every = 1
[solver]
criterion = "e8"
tolerance = 1e-12
[output]
record_every = 1
[[track]]
body = "first"
[[track]]
body = "second"
[[material]]
name = "stone"
density = 2500.0
[[law]]
name = "grain"
friction = 0.3
[[law]]
name = "tie"
{law}
[[interaction]]
candidate = "any"
antagonist = "any"
law = "grain"
[[body]]
name = "first"
shape = "disk"
radius = 0.1
position = [0.0, 0.0]
[[body]]
name = "second"
shape = "disk"
radius = 0.1
position = [0.1975, 0.0]
[[body]]
name = "post"
shape = "disk"
radius = 0.01
position = [{post}, 0.0]
fixed = true
[[link]]
bodies = ["second", "post"]
law = "tie"
"""
# Few sweeps leave much overlap.
LOOSE = ["--set", 'solver.method="nlgs"', "--set", "solver.maximum_sweeps=20", "--set", "output.record_every=1"]
RECOVERY = ["--set", "time.recovery=1e-4"]
OFF = ["--set", "time.recovery=0"]
# Overlap is what loads a spring.
ELASTIC = PRESSED.replace("friction = 0.3", 'name = "spring"\nkind = "ELASTIC_REPELL_CLB"\nstiffness = 1e6\nfriction = 0.3')


class Recovery(ProgramCase):
    def run_deck(self, text, output, *words, code=0):
        (self.place / "deck.toml").write_text(text)
        return self.run_program("run", "deck.toml", "--output", output, *words, code=code)

    def run_json(self, folder):
        return json.loads((self.place / folder / "run.json").read_text())

    def test_rest_stays_rest(self):
        """Grains that lie on each other without overlap, to the tolerance, are never pushed: the answer is that of a deck without."""
        resting = COMMON + FLOOR + grains(3)
        self.run_deck(resting, "without", "--set", "output.record_every=1", *OFF)
        self.run_deck(resting, "with", "--set", "output.record_every=1", "--set", "time.recovery=1e-3", "--set", "time.recovery_every=1")
        self.assertNotIn("recoveries", self.run_json("with"))
        self.assertEqual(self.rows("without"), self.rows("with"))

    def test_restart(self):
        """A run that is interrupted between two pushes goes on to the same numbers, digit by digit."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        words = [*LOOSE, *RECOVERY, "--quiet", "--set"]
        self.run_deck(PRESSED, "straight", *words, "time.steps=200")
        self.run_deck(PRESSED, "parts", *words, "time.steps=133")
        self.run_deck(PRESSED, "parts", *words, "time.steps=200", "--restart", "parts")
        self.assertGreater(self.run_json("straight")["recoveries"], 2)
        self.assertEqual(self.run_json("straight")["recoveries"], self.run_json("parts")["recoveries"])
        self.assertEqual(self.rows("straight"), self.rows("parts"))

    def test_subdomains(self):
        """On one subdomain and on several little is left of the overlap of loose solves (measured on one: a two-hundredth), what has
        settled rests, the balance of energy closes, and the log reports the pushes."""
        words = [*LOOSE, "--set", "time.steps=300"]
        self.run_deck(PRESSED, "without", *words, *OFF, "--quiet")
        without = self.run_json("without")
        for parts in (1, 2, 5):
            with self.subTest(parts=parts):
                said = self.run_deck(PRESSED, "with", *words, *RECOVERY, "--force", "--set", f"partition.parts={parts}").stdout
                run = self.run_json("with")
                self.assertLess(run["mean_penetration"], 0.1 * without["mean_penetration"])
                self.assertLess(run["kinetic_energy"], 1e-10)
                self.assertLess(run["energy_closure"], 1e-10)
                self.assertIn(f"recovered     bodies were pushed apart after {run['recoveries']} step", said)

    def test_links_keep_their_length(self):
        """A tied disk stays, and the other one takes the whole way; along a wire that is slack, or towards its post, both take half."""
        rod, wire = ("kind = \"{}\"\naxial_stiffness = 1e5".format(kind) for kind in ("ROD", "WIRE"))
        left, right = -1.0, 1.0
        for law, post, more, second in ((rod, left, "", 0.0), (rod, right, "", 0.0), (wire, left, "", 0.0), (wire, right, "", 0.00125),
                                        ('kind = "RIGID_WIRE"', left, "", 0.0), ('kind = "RIGID_WIRE"', right, "", 0.00125),
                                        ('kind = "RIGID_WIRE"', left, "length = 1.2", 0.00125)):
            with self.subTest(law=law, post=post, more=more):
                self.run_deck(TIED.format(law=law, post=post) + more + "\n", "out", "--quiet", "--force")
                x = {row["body"]: float(row["x"]) for row in self.rows("out", "tracks.csv")}
                # Overlap is undone to the e8 of 0.01 of a push; what is left of 1e-6 of the radius, 1e-7 m, is not pushed any more.
                self.assertAlmostEqual(x["second"], 0.1975 + second, delta=2e-7)
                self.assertAlmostEqual(x["first"], second - 0.0025, delta=4e-7)

    def test_a_membrane_that_confines_grains(self):
        """Next to wires that pull, overlap is undone on one subdomain and on three; wires keep their forces, and the balance closes."""
        if not self.has_hdf5():
            self.skipTest("the deck has stages, which need HDF5")
        deck = (Path(__file__).resolve().parents[2] / "input_decks/talk/membrane_biaxial.toml").read_text()
        self.assertIn("radius = [7e-3, 10.5e-3]", deck)
        # A sample of a fill of 0.78 grows in a quarter of the time of one of 0.8.
        self.assertIn("fill = 0.8\n", deck)
        deck = deck.replace("radius = [7e-3, 10.5e-3]", "radius = [0.012, 0.018]").replace("fill = 0.8\n", "fill = 0.78\n")
        words = ["--quiet", "--force", "--set", "time.steps=300", "--set", "solver.tolerance=0.1"]
        self.run_deck(deck, "without", *words, *OFF)
        without = self.run_json("without")
        for parts in (1, 3):
            with self.subTest(parts=parts):
                self.run_deck(deck, "with", *words, "--set", "time.recovery=3e-5", "--set", f"partition.parts={parts}")
                run = self.run_json("with")
                self.assertGreater(run["recoveries"], 2)
                # Measured on one subdomain: an eighth, while the sample is still being pressed together.
                self.assertLess(run["mean_penetration"], 0.3 * without["mean_penetration"])
                self.assertLess(run["energy_closure"], 1e-10)

    def test_default(self):
        """By default overlap is undone from 1e-4 of the smaller shape on; under a law that needs it, it stays."""
        words = [*LOOSE, "--quiet", "--force", "--set", "time.steps=300"]
        for name, more in (("silent", []), ("off", OFF), ("on", RECOVERY)):
            self.run_deck(PRESSED, name, *words, *more)
        self.assertEqual(self.rows("silent"), self.rows("on"))
        self.assertNotIn("recoveries", self.run_json("off"))
        self.assertGreater(self.run_json("on")["recoveries"], 2)
        # Measured: a ten-thousandth.
        self.assertLess(self.run_json("on")["volume_error"], 0.1 * self.run_json("off")["volume_error"])
        self.run_deck(ELASTIC, "elastic", *words)
        self.assertNotIn("recoveries", self.run_json("elastic"))

    def test_log(self):
        """The plan has whether overlap is undone, and the law that needs it where one does."""
        steps = ["--force", "--set", "time.steps=2"]
        said = self.run_deck(PRESSED, "out", *steps, *RECOVERY).stdout
        self.assertRegex(said, r"used  .*, recovery of overlap above 1\.00E-04 of the smaller shape\n")
        said = self.run_deck(PRESSED, "out", *steps, *OFF).stdout
        self.assertRegex(said, r"left out  .*, recovery of overlap\n")
        said = self.run_deck(ELASTIC, "out", *steps).stdout
        self.assertRegex(said, r'left out  .*, recovery of overlap \(law "spring" needs it\)\n')

    def test_rest_of_loose_solves(self):
        """Grains whose solves are so loose that they sink into each other while they rest go on resting between pushes: these leave 0.4
        of the overlap that the deck allows, so that contacts stay closed."""
        words = ["--set", 'solver.method="nlgs"', "--set", "solver.maximum_sweeps=6", "--set", "output.record_every=1", "--quiet", "--set",
                 "time.steps=600"]
        self.run_deck(PRESSED, "out", *words, "--set", "time.recovery=1e-2")
        run = self.run_json("out")
        self.assertGreater(run["recoveries"], 2)
        self.assertLess(run["kinetic_energy"], 1e-6)

    def test_contacts_that_carry_stay_closed(self):
        """A disk that lies on two fixed ones, deep in the left one and just touching the right one, is pushed out of the left one; the
        other contact, which a push along the normal alone would open by 0.8 of the way, stays closed after every push, and the
        disk at rest."""
        radius, half, deep = 0.1, 0.06, 5e-4
        left, right = 2 * radius - deep, 2 * radius
        x = (left**2 - right**2) / (4 * half)
        deck = TIED[:TIED.index("[[body]]")].replace('[[track]]\nbody = "second"\n', "").replace(
            '[[law]]\nname = "tie"\n{law}\n', "").replace("gravity = [0.0, 0.0]\n", "").replace("recovery = 1e-6", "recovery = 1e-4").replace(
            "steps = 8", "steps = 40").replace("friction = 0.3", "friction = 0.0")
        for name, place, more in (("first", (x, math.sqrt(right**2 - (half - x) ** 2)), ""), ("left", (-half, 0.0), "fixed = true\n"),
                                  ("right", (half, 0.0), "fixed = true\n")):
            deck += f'[[body]]\nname = "{name}"\nshape = "disk"\nradius = {radius}\nposition = [{place[0]!r}, {place[1]!r}]\n{more}'
        self.run_deck(deck, "out", "--quiet")
        places = [(float(row["x"]), float(row["y"])) for row in self.rows("out", "tracks.csv")]
        allowed = 1e-4 * radius
        for x, y in places:
            gap = math.hypot(x - half, y) - 2 * radius
            # 0.4 of what is allowed is the room; a tenth of what is allowed is what sweeps leave and turning normals add.
            self.assertLess(gap, 0.1 * allowed)
            self.assertGreater(gap, -0.5 * allowed)
        self.assertGreater(math.hypot(places[-1][0] + half, places[-1][1]) - 2 * radius, -allowed)
        self.assertLess(self.run_json("out")["kinetic_energy"], 1e-8)

    def test_no_room(self):
        """A grain between two fixed walls nearer to each other than it is wide stays where it is: a push would only move it into one of
        them."""
        walls = "".join(f"[[wall]]\nfrom = [-1.0, {y}]\nto = [1.0, {y}]\nthickness = 0.02\n" for y in (-0.1095, 0.1095))
        deck = TIED[:TIED.index("[[body]]")].replace('[[track]]\nbody = "second"\n', "").replace(
            '[[law]]\nname = "tie"\n{law}\n', "") + walls + (
            '[[body]]\nname = "first"\nshape = "disk"\nradius = 0.1\nposition = [0.0, 0.0]\n')
        self.run_deck(deck, "out", "--quiet")
        self.assertAlmostEqual(float(self.rows("out", "tracks.csv")[-1]["y"]), 0.0, delta=1e-12)
        self.assertNotIn("recoveries", self.run_json("out"))

    def test_refused(self):
        """Laws to which overlap belongs, with the place of the key."""
        start = COMMON.replace("[solver]", "recovery = 1e-3\n[solver]")
        for law in ('kind = "ELASTIC_REPELL_CLB"\nstiffness = 1e6', 'kind = "LINEAR"\nepsilon = 1.0'):
            with self.subTest(law=law):
                text = start.replace("friction = 0.3", law) + FLOOR + grains(3)
                said = self.run_deck(text, "out", "--quiet", code=2).stderr
                self.assertRegex(said, r'deck\.toml:4:12: error: overlap cannot be undone under the law ".*"')
                self.assertIn("^", said)
        for value in ("-1e-3", "2.0"):
            said = self.run_deck(start.replace("1e-3\n[solver]", f"{value}\n[solver]") + FLOOR + grains(3), "out", "--quiet", code=2).stderr
            self.assertRegex(said, r"deck\.toml:4:12: error: .*recovery")


if __name__ == "__main__":
    take_program()
    unittest.main()
