#!/usr/bin/env python3
"""Spectral radii of interface iterations: against the rate that the real solver shows, and what `splitgrain spectrum` refuses."""

import csv
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

TALK = Path(__file__).resolve().parents[2] / "input_decks/talk"
HEAD = '[time]\nstep = 1e-6\nsteps = 1\n[[material]]\nname = "stone"\ndensity = 1000.0\n[[law]]\n'
ROW = "".join(f'[[body]]\nshape = "disk"\nradius = 0.1\nposition = [{0.2 * i:.1f}, 0.0]\n' for i in range(4))


class Spectrum(ProgramCase):
    def setUp(self):
        super().setUp()
        if not self.has_library("LAPACK"):
            self.skipTest("built without LAPACK")

    def radii(self, *words):
        """Rows of the file of radii of a deck."""
        self.run_program("spectrum", *words, "--csv", "radii.csv")
        with open(self.place / "radii.csv", newline="") as file:
            return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]

    def observed_rate(self, deck, *settings, fall=1e4):
        """Rate per round at the end of a real solve, over such a fall of e8 of the whole problem, while rounding is far below it."""
        self.run_program("run", deck, "--output", "run", "--force", "--quiet",
                         *(word for setting in settings for word in ("--set", setting)))  # fmt: skip
        with open(self.place / "run/trace.csv", newline="") as file:
            rows = [(int(row["iteration"]), float(row["e8"])) for row in csv.DictReader(file)]
        sweeps = rows[1][0]
        last = max(i for i, row in enumerate(rows) if row[1] > 1e-11)
        first = max(i for i, row in enumerate(rows) if row[1] > fall * rows[last][1])
        rounds = (rows[last][0] - rows[first][0]) / sweeps
        return (rows[last][1] / rows[first][1]) ** (1 / rounds)

    def test_observed_rate(self):
        """The rate of the real dual solver is the spectral radius to three digits; of eight disks with epsilon_0 the second
        eigenvalue is so near the first that four digits of fall do not part them."""
        for deck, epsilon in (("four", 1.0), ("four", 0.02), ("eight", 0.1), ("eight", 0.02), ("twelve", 1.0), ("twelve", 0.1)):
            with self.subTest(deck=deck, epsilon=epsilon):
                file = TALK / f"{deck}_disks.toml"
                radius = self.radii(file, "--epsilon", epsilon, "--points", 1)[0]["dual"]
                rate = self.observed_rate(file, f"law[1].relative_epsilon={epsilon}")
                self.assertAlmostEqual(rate / radius, 1, delta=5e-4)

    def test_observed_rate_of_the_enriched_interface(self):
        """The same for the enriched interface, its systems solved to rounding, with eta below and above epsilon."""
        for deck, place in (("four", 9), ("eight", 5), ("eight", 7), ("twelve", 9)):
            with self.subTest(deck=deck, place=place):
                file = TALK / f"{deck}_disks.toml"
                row = self.radii(file, "--epsilon", 0.1, "--points", 2)[place]
                text = self.run_program("spectrum", file, "--points", 1).stdout
                epsilon_0 = float(re.search(r"epsilon_0\s+(\S+)", text)[1])
                rate = self.observed_rate(file, "law[1].relative_epsilon=0.1", 'partition.gluing="enriched"',
                                          'partition.enriched.scale="absolute"', "partition.enriched.tolerance=1e-12",
                                          f"partition.enriched.eta={row['eta'] * epsilon_0}")  # fmt: skip
                self.assertAlmostEqual(rate / row["enriched"], 1, delta=1e-3)

    def test_rate_with_momentum(self):
        """Sweeps with momentum, which restarts in each half period of the slowest mode: 1 - rate is no more than the theory's
        square root of 1 - lambda, with the rate lambda of plain rounds, and at least half of it."""
        for deck, parts in (("eight", 2), ("twelve", 0), ("twelve", 2)):
            with self.subTest(deck=deck, parts=parts):
                words = TALK / f"{deck}_disks.toml", "law[1].relative_epsilon=0.02", "partition.sweeps=1", f"partition.parts={parts}"
                plain = self.observed_rate(*words)
                rate = self.observed_rate(*words, 'solver.method="nesterov"', fall=1e8)
                self.assertLess(0.5, (1 - rate) / (1 - plain) ** 0.5)
                self.assertLess((1 - rate) / (1 - plain) ** 0.5, 1)

    def test_one_iteration(self):
        """With eta = epsilon nothing is left after one iteration; a large eta is the dual method."""
        rows = self.radii(TALK / "twelve_disks.toml", "--points", 2)
        self.assertLess(min(row["enriched"] for row in rows if abs(row["eta"] - 1) < 1e-12), 1e-12)
        self.assertAlmostEqual(rows[-1]["enriched"], rows[-1]["dual"], delta=1e-3)
        self.assertTrue(all(row["dual"] == rows[0]["dual"] for row in rows))

    def test_contact(self):
        """Near the solution of a problem of contact: a row of disks that one end is pushed into, and one that falls apart."""
        pushed = HEAD + "[[interaction]]\nalert = 0.01\n" + ROW.replace("[0.0, 0.0]", "[0.0, 0.0]\nvelocity = [1.0, 0.0]", 1)
        (self.place / "pushed.toml").write_text(pushed)
        printed = self.run_program("spectrum", "pushed.toml").stdout
        self.assertIn("3 of them carry an impulse", printed)
        (self.place / "apart.toml").write_text(pushed.replace("[1.0, 0.0]", "[-1.0, 0.0]", 1))
        printed = self.run_program("spectrum", "apart.toml", "--points", 1).stdout
        self.assertIn("0 of them carry an impulse", printed)

    def refused(self, sentence, text, *words):
        (self.place / "bad.toml").write_text(text)
        printed = self.run_program("spectrum", "bad.toml", *words, code=2).stderr
        self.assertIn(sentence, printed)
        self.assertEqual(len([line for line in printed.splitlines() if line.startswith("error") or ": error:" in line]), 1, printed)

    def test_refusals(self):
        close = HEAD + "[[interaction]]\nalert = 0.01\n" + ROW
        linear = HEAD.replace("[[law]]", '[[law]]\nkind = "LINEAR"\nepsilon = 1.0') + "[[interaction]]\nalert = 0.01\n" + ROW
        self.refused("too few for 9 parts", linear, "--parts", "9")
        self.refused("--parts needs", linear, "--parts", "1")
        self.refused("--epsilon needs a number above zero", linear, "--epsilon", "0")
        self.refused("has no contacts", close.replace("0.2, 0.0]", "9.2, 0.0]").replace("0.4, 0.0]", "9.4, 9.0]").replace(
            "0.6, 0.0]", "0.6, 9.0]"))  # fmt: skip
        self.refused("share no body", linear.replace("[0.2, 0.0]", "[0.2, 0.0]\nfixed = true").replace(
            "[0.4, 0.0]", "[0.4, 0.0]\nfixed = true"))  # fmt: skip
        self.refused("full matrices are made for at most", linear + '[[sample]]\nkind = "lattice"\nbox = [0.0, 1.0, 8.0, 9.0]\n'
                     "radius = 0.1\nspacing = 1.0\n")  # fmt: skip


if __name__ == "__main__":
    take_program()
    unittest.main()
