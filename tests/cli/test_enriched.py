#!/usr/bin/env python3
"""The enriched interface from outside, its subdomains in one process: the answer of one subdomain on any number of them, scenes that
leave a subdomain without contacts, without support or with a driven grain on its interface, what fails on the way, and what is
refused."""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402
from ranks_case import COMMON, FLOOR, PRESSED, SIDES, grains  # noqa: E402

GLUED = ["--set", 'partition.gluing="enriched"']
STILL = "".join(f'[[drive]]\nbody = {body}\ncomponent = "{component}"\nvalue = 0.0\n'
                for body in (25, 32, 39) for component in ("x", "y", "rotation"))  # fmt: skip
# A residual of 1e-6 leaves this much freedom to positions and velocities.
KEPT = {"kinetic_energy": 1e-6, "potential_energy": 1.0, "compactness": 1.0, "contacts": 1.0}


class Enriched(ProgramCase):
    def run_deck(self, text, output, *words, code=0):
        (self.place / "deck.toml").write_text(text)
        return self.run_program("run", "deck.toml", "--force", "--output", output, *words, code=code)

    def run_json(self, folder):
        return json.loads((self.place / folder / "run.json").read_text())

    def check_same(self, text, parts, *words):
        """A deck has the same answer on one subdomain and on some, and its steps converge."""
        self.run_deck(text, "one", "--quiet")
        one = self.run_json("one")
        for n in parts:
            with self.subTest(parts=n):
                self.run_deck(text, "many", "--quiet", *GLUED, "--set", f"partition.parts={n}", *words)
                many = self.run_json("many")
                self.assertEqual((many["subdomains"], many["unconverged_steps"]), (n, 0))
                for key, scale in KEPT.items():
                    self.assertAlmostEqual(one[key], many[key], delta=1e-4 * max(abs(one[key]), scale), msg=key)
        return many

    def test_any_number_of_subdomains(self):
        many = self.check_same(PRESSED, (1, 2, 5, 9))
        self.assertGreater(many["interface_iterations"], 0)
        self.assertGreater(many["factorisations"], 0)
        self.assertEqual((many["failed_systems"], many["failed_factors"]), (0, 0))

    def test_automatic(self):
        self.check_same(PRESSED, (4,), "--set", "partition.enriched.automatic=true")

    def test_subdomains_without_contacts(self):
        """More subdomains than grains, and grains in free fall."""
        self.check_same(COMMON + FLOOR + grains(3), (8,))
        self.check_same(COMMON.replace("steps = 60", "steps = 5") + grains(3), (2,))

    def test_floating_subdomains(self):
        """Layers of grains between a floor and a lid: those between touch no wall."""
        self.check_same(PRESSED, (3,), "--set", "partition.boxes=[1, 3]")

    def test_grains_of_infinite_mass_on_the_interface(self):
        self.check_same(COMMON + FLOOR + SIDES + grains(60) + STILL, (4, 8))

    def test_what_fails_is_reported(self):
        """And every step is solved as without: where eta leaves masses no digits, no subdomain has a factor."""
        for words, said in ((["partition.enriched.most_iterations=1", "partition.enriched.tolerance=1e-12"],
                             r"[1-9]\d* systems did not converge and 0 matrices had no"),
                            (["partition.enriched.eta=1e-30"], r"0 systems did not converge and [1-9]\d* matrices had no")):  # fmt: skip
            with self.subTest(words):
                settings = [word for setting in words for word in ("--set", setting)]
                printed = self.run_deck(PRESSED, "many", *GLUED, *settings, "--set", "partition.parts=4").stdout
                self.assertRegex(printed, said + "[^;]*")
                self.assertEqual(self.run_json("many")["unconverged_steps"], 0)

    def test_reports(self):
        """The log has iterations and factorisations. Matrices of subdomains are listed, with the entries that the mapping of
        contacts makes."""
        printed = self.run_deck(PRESSED, "listed", *GLUED, "--needs", "--set", "partition.parts=4").stdout
        self.assertRegex(printed, r"interface +[1-9][\d.]* iterations and [\d.]+ factorisations of a subdomain per step\n")
        needs = json.loads((self.place / "listed/needs.json").read_text())
        values, columns, mass = (needs[f"subdomain factor.{name}"] for name in ("matrix_value", "matrix_column", "mass"))
        self.assertEqual(values, 2 * columns)
        self.assertGreater(values, mass)
        self.assertGreater(mass, 0)
        self.assertGreaterEqual(needs["table_bytes"], sum(size for name, size in needs.items() if "." in name))

    def test_refused(self):
        """Numbers out of range, with their place and a caret."""
        enriched = '[partition]\ngluing = "enriched"\n[partition.enriched]\n'
        linear = COMMON.replace("friction = 0.3", 'kind = "LINEAR"\nKEY = VALUE')
        cases = [(COMMON + FLOOR + grains(3) + enriched, key, value, bound) for key, value, bound in (
            ("eta", "0.0", "larger than 0"), ("eta", "-1.0", "larger than 0"), ("tolerance", "0.0", "larger than 0"),
            ("tolerance", "2.0", "at most 1"), ("changes", "-0.1", "at least 0"))]  # fmt: skip
        cases = [(text + f"{key} = {value}\n", key, value, bound) for text, key, value, bound in cases]
        for key in ("epsilon", "relative_epsilon"):
            for value in ("0.0", "-1.0"):
                cases.append((linear.replace("KEY", key).replace("VALUE", value) + FLOOR + grains(3), key, value, "larger than 0"))
        for text, key, value, bound in cases:
            with self.subTest(f"{key} = {value}"):
                line = text[: text.index(f"\n{key} = {value}")].count("\n") + 2
                said = self.run_deck(text, "refused", code=2).stderr
                self.assertEqual(said.count("error:"), 1, said)
                self.assertRegex(said, rf'deck.toml:{line}:\d+: error: .*"{key}" must be {bound}')
                shown, caret = said.splitlines()[1:3]
                self.assertIn(f"{key} = {value}", shown)
                self.assertTrue(re.fullmatch(r"[ |]*\^+", caret), said)


if __name__ == "__main__":
    take_program()
    unittest.main()
