#!/usr/bin/env python3
"""Moments that resist rolling and twisting, from decks: closed forms of the deck, restarts, columns of pictures, ranks, and what
refuses them."""

import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

DECK = Path(__file__).resolve().parents[2] / "input_decks" / "rolling_resistance.toml"
GLUED = (DECK.parent / "hanging_stones.toml").read_text()
HEAD = """[scene]
gravity = [2.0, -9.0]
[time]
step = 2e-3
steps = 60
[solver]
tolerance = 1e-9
[output]
record_every = 1
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.4
rolling_friction = 0.1
"""
BOX = """[[wall]]
name = "floor"
from = [-0.1, -0.01]
to = [1.1, -0.01]
thickness = 0.02
[[wall]]
from = [1.01, 0.0]
to = [1.01, 1.0]
thickness = 0.02
[[sample]]
box = [0.0, 0.0, 0.8, 0.6]
kind = "lattice"
radius = 0.05
spacing = 1.02
"""


def beside_glue(is_in_space):
    """Stones that hang by cohesive zones until these break, and far from them a ball that rolls on a floor."""
    head, *bodies = GLUED.split("[[body]]")
    floor = 'centre = [6.0, 0.0, 0.0]\nnormal = [0.0, 1.0, 0.0]\nsize = [4.0, 1.0]\n' if is_in_space else \
        'from = [4.0, -0.05]\nto = [8.0, -0.05]\n'
    text = "[[body]]".join([head, *bodies])
    if is_in_space:
        text = "[scene]\ndimension = 3\n" + head.replace("[[gravity]]", '[[gravity]]\ncomponent = "z"\nvalue = 0.0\n[[gravity]]')
        for i, block in enumerate(bodies):
            height, centre = (0.125, 0.125 - 0.25 * i) if i else (0.05, 0.05)
            text += f'[[body]]\nname = "{block.split(chr(34))[1]}"\nshape = "box"\nhalf_axes = [0.2, {height}, 0.2]\n'
            text += f"position = [0.0, {centre}, 0.0]\n" + "fixed = true\n" * (i == 0)
        text += '[[track]]\nbody = "stone_1"\n'
    shape, zero, spin = ("sphere", ", 0.0", "[0.0, 0.0, -10.0]") if is_in_space else ("disk", "", "-10.0")
    return (text + f'[[wall]]\nname = "floor"\n{floor}thickness = 0.1\n[[body]]\nname = "ball"\nshape = "{shape}"\nradius = 0.1\n'
            f'position = [5.0, 0.1{zero}]\nvelocity = [1.0, 0.0{zero}]\nspin = {spin}\n[[track]]\nbody = "ball"\n')


class Rolling(ProgramCase):
    def test_slope(self):
        """Of three spheres on a slope one rolls, one rests, one spins to rest: as the deck's closed forms have it."""
        self.run_program("run", DECK, "--output", "out", "--quiet", "--force")
        tracks = self.rows(file="tracks.csv")
        down = 1 / math.sqrt(1.01)
        at = {name: [row for row in tracks if row["body"] == name] for name in ("rolls", "rests", "spins")}
        last = {name: rows[-1] for name, rows in at.items()}
        speed = 5 / 7 * 9.81 * (0.1 - 0.05) * down * float(last["rolls"]["time"])
        self.assertAlmostEqual(float(last["rolls"]["velocity_x"]), speed * down, delta=1e-8)
        self.assertLess(abs(float(last["rests"]["velocity_x"])), 1e-8)
        self.assertLess(abs(float(last["spins"]["velocity_x"])), 1e-8)
        for row in at["spins"]:
            spin = max(0.0, 20 - 2.5 * 0.08 * 9.81 * down / 0.1 * float(row["time"]))
            self.assertAlmostEqual(float(row["spin_z"]), spin * down, delta=1e-5)
        self.assertLess(float(self.rows()[-1]["energy_closure"]), 1e-8)

    def test_restart_and_ranks(self):
        """A run that goes on from a checkpoint ends as one that never stopped, to the last digit; ranks find the same energies."""
        text = HEAD + BOX
        words = ("--set", "restart.every=30", "--set", "restart.at_end=false")
        self.run_deck(text, *(words if self.has_hdf5() else words[2:]))
        last = self.rows()[-1]
        self.assertGreater(float(last["rolling_loss"]), 0.01)
        self.assertLess(float(last["energy_closure"]), 1e-7)
        if self.has_hdf5():
            self.run_deck(text, *words, "--restart", "out/restart_a.h5", output="again")
            self.assertEqual(self.rows(output="again")[-1], last)
        if not self.launcher:
            return
        self.on_ranks(2, text, "ranks", *words[2:])
        for key in ("rolling_loss", "friction_loss", "kinetic_energy"):
            # Impacts enlarge what the solver leaves.
            ratio = float(self.rows(output="ranks")[-1][key]) / float(last[key])
            self.assertAlmostEqual(ratio, 1.0, delta=1e-2, msg=key)

    def test_datbox(self):
        """Next to a DATBOX a law gets moments by its name there: the run is that of the deck, and so is that of its effective deck."""
        text = HEAD.replace("[[law]]", '[[law]]\nname = "rub"') + BOX
        self.run_deck(text, output="native")
        (self.place / "deck.toml").write_text(text.replace("rolling_friction = 0.1\n", ""))
        self.run_program("convert", "deck.toml", "DATBOX")
        head = text[:text.index("[[material]]")].replace("[scene]", '[scene]\ndatbox = "DATBOX"')
        law = '[[law]]\nname = "rub"\nrolling_friction = 0.1\n'
        self.run_deck(head + law)
        native, last = self.rows("native")[-1], self.rows()[-1]
        for key in ("rolling_loss", "friction_loss", "kinetic_energy"):
            # Files hold 14 digits; impacts enlarge what that leaves.
            self.assertAlmostEqual(float(last[key]) / float(native[key]), 1.0, delta=1e-3, msg=key)
        (self.place / "deck.toml").write_text((self.place / "out/effective.toml").read_text())
        self.run_program("check", "deck.toml")
        for more, sentence in ((law.replace("rub", "rob"), 'did you mean "rub"'), (law + "friction = 0.2\n", "adds moments")):
            self.assertIn(sentence, self.run_deck(head + more, code=2).stderr)

    def test_cohesive_zones(self):
        """Next to cohesive zones: stones hang and break loose as without moments, the ball rolls as without bonds; restarts, ranks."""
        for is_in_space in (False, True):
            with self.subTest(is_in_space=is_in_space):
                text = beside_glue(is_in_space)
                self.run_deck(text, output="without")
                text = text.replace('name = "contact"\n', 'name = "contact"\nrolling_friction = 0.1\n')
                words = ("--set", "restart.every=450", "--set", "restart.at_end=false") if self.has_hdf5() else ()
                self.run_deck(text, *words)
                last = self.rows()[-1]
                self.assertEqual(int(last["bonds"]), 12 if is_in_space else 6)
                # Tolerance 1e-8, on energies that balance to rounding.
                self.assertLess(max(float(row["energy_closure"]) for row in self.rows()), 1e-9)
                tracks = self.rows(file="tracks.csv")
                for ours, theirs in zip(tracks, self.rows("without", "tracks.csv"), strict=True):
                    if ours["body"] != "ball":
                        # Bonds of 1e9 Pa/m amplify what the solver leaves: 1e-8 of velocities of 1 m/s.
                        self.assertAlmostEqual(float(ours["velocity_y"]), float(theirs["velocity_y"]), delta=1e-7)
                        continue
                    # Gravity of 20 t is summed up exactly.
                    lost = 0.1 * 10 * float(ours["time"]) ** 2 / (1.4 if is_in_space else 1.5)
                    self.assertAlmostEqual(float(ours["velocity_x"]), 1 - lost, delta=1e-7)
                    self.assertAlmostEqual(float(theirs["velocity_x"]), 1, delta=1e-7)
                if self.has_hdf5():
                    self.run_deck(text, *words, "--restart", "out/restart_a.h5", output="again")
                    self.assertEqual(self.rows("again")[-1], last)
                if self.launcher:
                    # From the checkpoint before the bonds break.
                    restart = ["--force", "--restart", "out/restart_a.h5"] if self.has_hdf5() else []
                    self.on_ranks(2, text, "ranks", "--set", "restart.at_end=false", *restart)
                    self.assertEqual(self.rows("ranks")[-1]["bonds"], last["bonds"])
                    for key in ("rolling_loss", "bond_loss", "kinetic_energy"):
                        self.assertAlmostEqual(float(self.rows("ranks")[-1][key]) / float(last[key]), 1.0, delta=1e-6, msg=key)

    def test_added_later(self):
        """A run may go on from one without moments, and stages may change them."""
        if not self.has_hdf5():
            self.skipTest("checkpoints need HDF5")
        for dimension in (2, 3):
            ball = ('[scene]\ndimension = 3\ngravity = [1.0, 0.0, -9.0]\n' if dimension == 3 else '[scene]\ngravity = [1.0, -9.0]\n')
            ball += '[[wall]]\nname = "floor"\n'
            ball += ('centre = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nsize = [9.0, 9.0]\n' if dimension == 3 else
                     'from = [-5.0, -0.05]\nto = [5.0, -0.05]\n') + 'thickness = 0.1\n'
            centre = "[0.0, 0.0, 0.1]" if dimension == 3 else "[0.0, 0.1]"
            ball += f'[[body]]\nname = "ball"\nshape = "{"sphere" if dimension == 3 else "disk"}"\nradius = 0.1\nposition = {centre}\n'
            text = HEAD[HEAD.index("[time]"):].replace("steps = 60\n", "") + ball + '[[track]]\nbody = "ball"\n'
            gain = 0.1 / (1.4 if dimension == 3 else 1.5)
            without = text.replace("rolling_friction = 0.1\n", "").replace("step = 2e-3\n", "step = 2e-3\nsteps = 50\n")
            self.run_deck(without)
            self.assertAlmostEqual(float(self.rows(file="tracks.csv")[-1]["velocity_x"]), gain, delta=1e-6)
            # Against 1 m/s2 along the floor act 0.15 times 9 m/s2.
            more = text.replace("rolling_friction = 0.1", "rolling_friction = 0.15").replace("step = 2e-3\n", "step = 2e-3\nsteps = 100\n")
            self.run_deck(more, "--restart", "out/restart_a.h5", output="on")
            self.assertAlmostEqual(float(self.rows("on", "tracks.csv")[-1]["velocity_x"]), 0.65 * gain, delta=1e-6)
            stages = "[[stage]]\nsteps = 50\n[[stage.law]]\nrolling_friction = {}\n[[stage]]\nsteps = 50\n{}"
            on = text.replace("rolling_friction = 0.1", "rolling_friction = 0.15")
            # From none to some, by what the first stage or the second one changes; and back to none.
            for deck, first, second, speed in ((on, "0.0", "", 0.65), (text.replace("rolling_friction = 0.1\n", ""), "0.0",
                                               "[[stage.law]]\nrolling_friction = 0.15\n", 0.65),
                                               (on, "0.05", "[[stage.law]]\nrolling_friction = 0.0\n", 1.55)):
                self.run_deck(deck + stages.format(first, second), "--set", "output.every=50", output="stages")
                self.assertAlmostEqual(float(self.rows("stages", "tracks.csv")[-1]["velocity_x"]), speed * gain, delta=1e-6)
                rows = self.rows("stages")
                self.assertEqual(len(rows), 100)
                self.assertLess(max(float(row["energy_closure"]) for row in rows), 1e-7)
                self.assertEqual(float(rows[49]["rolling_loss"]) > 1e-9, first != "0.0")

    def test_columns(self):
        """Pictures of contacts hold the moments, within their bounds; scenes whose laws resist no rolling have neither those nor
        the column of the record."""
        if not self.has_hdf5():
            self.skipTest("pictures need HDF5")
        try:
            import h5py
            import numpy
        except ImportError:
            self.skipTest("no h5py")

        for name, text in (("with", HEAD + BOX), ("without", HEAD.replace("rolling_friction = 0.1\n", "") + BOX)):
            self.run_deck(text, "--set", "output.every=60", output=name)
            with h5py.File(self.place / name / "contacts.vtkhdf") as file:
                data = file["VTKHDF/CellData"]
                self.assertEqual("rolling_moment" in data, name == "with")
                self.assertNotIn("twisting_moment", data)
                if name == "with":
                    moments = numpy.abs(data["rolling_moment"][:])
                    self.assertGreater(moments.max(), 0.0)
                    # The largest effective radius is that of a grain on a wall.
                    self.assertTrue((moments <= 0.1 * 0.05 * data["force_normal"][:] * (1 + 1e-12)).all())
            self.assertEqual("rolling_loss" in self.rows(output=name)[-1], name == "with")

    def test_refusals(self):
        """One sentence with line and caret for what has no place for moments."""
        for text, sentence, caret in (
            (HEAD.replace("rolling_friction = 0.1", "rolling_friction = -0.1") + BOX, "rolling_friction", "  rolling_friction = -0.1"),
            (HEAD.replace("rolling_friction", "twisting_friction") + BOX, "twisting_friction", "  twisting_friction = 0.1"),
        ):
            done = self.run_deck(text, code=2)
            self.assertIn(sentence, done.stderr)
            self.assertIn(caret + "\n", done.stderr)
        matrices = HEAD.replace("tolerance = 1e-9", 'method = "accelerated"\ntolerance = 1e-9') + BOX
        if self.launcher:
            (self.place / "deck.toml").write_text(matrices)
            done = self.call("--quiet", ranks=2, code=2)
            self.assertIn("matrices, which have no place", done.stderr)
            self.assertIn('  method = "accelerated"\n', done.stderr)
            (self.place / "deck.toml").write_text(HEAD + BOX + '[partition]\ngluing = "enriched"\n')
            self.assertIn('the coupling "enriched" takes matrices', self.call("--quiet", ranks=2, code=2).stderr)
        # On one rank sweeps take over, with the answer that they give anyway.
        done = self.run_deck(matrices)
        self.assertIn("steps with such contacts are solved by sweeps", done.stderr)
        last = self.rows()[-1]
        self.run_deck(matrices.replace("accelerated", "nlgs"), output="swept")
        self.assertEqual(last, self.rows("swept")[-1])
        (self.place / "deck.toml").write_text(HEAD + BOX)
        done = self.run_program("convert", "deck.toml", "folder", code=2)
        self.assertIn("none resists rolling or twisting there", done.stdout + done.stderr)
        if self.has_hdf5():
            done = self.run_deck(HEAD + BOX, "--dump", "50")
            self.assertIn("no place for it", done.stdout + done.stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
