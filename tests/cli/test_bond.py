#!/usr/bin/env python3
"""Bonds between named bodies or all shapes of a colour: the strength at which they break, restarts, ranks, a DATBOX, mistakes."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

DECK = (Path(__file__).resolve().parents[2] / "input_decks" / "hanging_stones.toml").read_text()
NAMED = '[[bond]]\nbodies = ["ceiling", "stone_1"]\nlaw = "glue"\n\n[[bond]]\nbodies = ["stone_*", "stone_*"]    # each to each that it touches\n'
COLOUR = '[[bond]]\ncolour = "glued"\n'
BREAKS = 0.5
"""Time at which the weight of four stones reaches the strength of the glue [s]"""
STEP = 1e-3


def coloured(text):
    """The deck with a bond between all shapes of a colour."""
    blocks = text.replace(NAMED, COLOUR).split("[[body]]")
    return "[[body]]".join(blocks[:1] + [block if '"loose"' in block else "\ncolour = \"glued\"" + block for block in blocks[1:]])


class Bond(ProgramCase):
    def check_strength(self, output="out"):
        """The glue at the ceiling holds the first body tracked until its strength is reached; the second one, not glued, falls from
        the start."""
        rows = self.rows(output, "tracks.csv")
        glued, loose = rows[::2], rows[1::2]
        for row in loose:
            # Gravity of a step is the mean of its ends: 20 t^2/2 is exact.
            self.assertAlmostEqual(float(row["velocity_y"]), -10 * float(row["time"]) ** 2, delta=1e-9)
        rest = max(float(row["time"]) for row in glued if abs(float(row["velocity_y"])) < 1e-3)
        # Rows are 5 steps apart; what the glue still carries while it breaks holds the stones up for some steps more.
        self.assertGreater(rest, BREAKS - 5 * STEP - 1e-9)
        self.assertLess(rest, BREAKS + 10 * STEP + 1e-9)
        late, last = glued[-10], glued[-1]
        gained = -10 * (float(last["time"]) ** 2 - float(late["time"]) ** 2)
        self.assertAlmostEqual(float(last["velocity_y"]) - float(late["velocity_y"]), gained, delta=1e-6)

    def test_named(self):
        """Named bodies: of eight bonded points two break, and the others hold the stones together."""
        self.run_deck(DECK)
        self.check_strength()
        rows = self.rows()
        self.assertEqual({int(row["bonds"]) for row in rows if float(row["time"]) < BREAKS}, {8})
        self.assertEqual(int(rows[-1]["bonds"]), 6)

    def test_colour(self):
        """All shapes of a colour: the same bonds."""
        self.run_deck(coloured(DECK))
        self.check_strength()
        self.assertEqual(int(self.rows()[-1]["bonds"]), 6)

    def test_stress_of_mohr(self):
        """A Mohr-Coulomb law with a bond stress breaks at the same load."""
        zone = DECK[DECK.index('kind = "IQS_MAL_CZM"'):DECK.index("[[bond]]")]
        self.run_deck(DECK.replace(zone, 'kind = "IQS_MOHR_DS_CLB"\nfriction = 0.5\nnormal_bond_stress = 2e4\ntangential_bond_stress = 2e4\n\n'))
        self.check_strength()

    def test_space(self):
        """Boxes in space, bonded over their faces."""
        head, *bodies = DECK.split("[[body]]")
        text = "[scene]\ndimension = 3\n" + head
        for i, block in enumerate(bodies):
            name = block.split('"')[1]
            height = 0.05 if i == 0 else 0.125
            centre = height if i == 0 else 0.125 - 0.25 * i
            text += f'[[body]]\nname = "{name}"\nshape = "box"\nhalf_axes = [0.2, {height}, 0.2]\nposition = [0.0, {centre}, 0.0]\n'
            text += "fixed = true\n" * (i == 0)
        text += "[[track]]\nbody = \"stone_1\"\n[[track]]\nbody = \"loose\"\n"
        self.run_deck(text.replace("[[gravity]]", "[[gravity]]\ncomponent = \"z\"\nvalue = 0.0\n[[gravity]]"))
        self.check_strength()

    def test_restart_and_ranks(self):
        """Bonds outlast a restart to the last digit, and ranks that share the stones have the same."""
        words = ("--set", "restart.every=450", "--set", "restart.at_end=false")
        self.run_deck(DECK, *(words if self.has_hdf5() else ()))
        if self.has_hdf5():
            self.run_deck(DECK, *words, "--restart", "out/restart_a.h5", output="again")
            self.assertEqual(self.rows("again")[-1], self.rows()[-1])
        if not self.launcher:
            return
        for text in (DECK, coloured(DECK)):
            self.on_ranks(2, text, "ranks")
            self.check_strength("ranks")
            self.assertEqual(int(self.rows("ranks")[-1]["bonds"]), 6)

    def test_datbox(self):
        """Next to a DATBOX: bodies by number, the law by its name there. A folder itself holds no named bodies."""
        (self.place / "deck.toml").write_text(DECK)
        done = self.run_program("convert", "deck.toml", "named", code=2)
        self.assertIn("a DATBOX holds no bonds between named bodies", done.stdout + done.stderr)
        lines = DECK[DECK.index("[[gravity]]"):DECK.index("[[material]]")]
        plain = DECK.replace(NAMED + 'law = "glue"\n', '[[interaction]]\nlaw = "contact"\n').replace(lines, "")
        (self.place / "deck.toml").write_text(plain)
        self.run_program("convert", "deck.toml", "DATBOX")
        head = DECK[:DECK.index("[[material]]")].replace("[time]", '[scene]\ndatbox = "DATBOX"\n[time]', 1)
        bonds = "".join(f'[[bond]]\nbodies = [{a}, {b}]\nlaw = "glue"\n' for a, b in ((1, 2), (2, 3), (3, 4), (4, 5)))
        done = self.run_deck(head + bonds + "[[track]]\nbody = 2\n[[track]]\nbody = 6\n")
        self.assertNotIn("no see table names the contact law", done.stderr)
        self.check_strength()

    def test_mistakes(self):
        """One sentence with a caret for what makes no bond."""
        for old, new, sentence in (
            ('bodies = ["ceiling", "stone_1"]', 'bodies = ["ceilin", "stone_1"]', 'did you mean "ceiling"'),
            ('bodies = ["ceiling", "stone_1"]', 'bodies = [1, 9]', "there is no body 9: the scene has 6"),
            ('bodies = ["ceiling", "stone_1"]', "", 'give "bodies" or "colour"'),
            ('bodies = ["ceiling", "stone_1"]', 'colour = "red"', 'no body has the colour "red"'),
            ('"stone_1"]\nlaw = "glue"', '"stone_1"]\nlaw = "contact"', 'the law "contact" holds nothing together'),
            ('"stone_1"]\nlaw = "glue"', '"stone_1"]', 'lacks the key "law"'),
        ):
            self.assertIn(old, DECK)
            done = self.run_deck(DECK.replace(old, new, 1), code=2)
            self.assertIn(sentence, done.stderr)
            self.assertIn("^", done.stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
