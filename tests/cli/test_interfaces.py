#!/usr/bin/env python3
"""Interfaces from outside: closed forms of resultants, centre of pressure and joint, the sums of all pairs against the forces on bodies,
restarts to the byte, several ranks, and pairs that make no sense."""

import csv
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

G = 9.81
START = """[time]
step = 1e-3
steps = {steps}
[solver]
criterion = "e8"
tolerance = 1e-12
maximum_sweeps = 20000
[output]
record_every = {every}
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = {friction}
"""
FLOOR = '[[wall]]\nname = "floor"\nfrom = [-3.0, -0.05]\nto = [3.0, -0.05]\nthickness = 0.1\n'
SOLID_FLOOR = '[[wall]]\nname = "floor"\ncentre = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nsize = [6.0, 6.0]\nthickness = 0.1\n'
# Of the solver (1e-12 of the largest impulse), over sums of a few contacts.
EXACT = 1e-9


def block(name, x, y, width, height, more="", depth=None):
    """A block of a width and height about a place; in space, where it has a depth, y is its height."""
    a, b = width / 2, height / 2
    if depth:
        return (f'[[body]]\nname = "{name}"\nshape = "box"\nhalf_axes = [{a}, {depth / 2}, {b}]\nposition = [{x}, 0.0, {y}]\n{more}')
    return (f'[[body]]\nname = "{name}"\nshape = "polygon"\nvertices = [[{-a}, {-b}], [{a}, {-b}], [{a}, {b}], [{-a}, {b}]]\n'
            f'position = [{x}, {y}]\n{more}')


def start(steps=20, every=20, friction=0.9):
    return START.format(steps=steps, every=every, friction=friction)


class Interfaces(ProgramCase):
    def pairs(self, output="out", file="interfaces.csv"):
        """Rows of a file with numbers for words."""
        with (self.place / output / file).open(newline="") as lines:
            return [{name: word if name in ("first", "second", "body") else float(word) for name, word in row.items()}
                    for row in csv.DictReader(lines)]

    def check(self, row, **wanted):
        scale = max(abs(row["normal_force"]), 1.0)
        for name, value in wanted.items():
            self.assertLessEqual(abs(row[name] - value), EXACT * scale, f"{name}: {row[name]} is not {value}")

    def test_slope(self):
        """A block on a slope: N = W cos a, T = W sin a, the pressure below its centre of mass at h/2 tan a down the slope."""
        angle, width, height, depth = 0.4, 0.3, 0.2, 0.5
        for is_in_space in (False, True):
            down = (G * math.sin(angle), -G * math.cos(angle))
            scene = f"[scene]\ngravity = [{down[0]}, {down[1]}]\n"
            if is_in_space:
                scene = f"[scene]\ndimension = 3\ngravity = [{down[0]}, 0.0, {down[1]}]\n"
            self.run_deck(scene + start() + (SOLID_FLOOR if is_in_space else FLOOR)
                          + block("block", 0.1, 0.1, width, height, depth=depth if is_in_space else None)
                          + '[[interface]]\nbetween = ["block", "floor"]\n')
            row, = self.pairs()
            weight = 2500 * width * height * G * (depth if is_in_space else 1)
            off = height / 2 * math.tan(angle)
            self.assertEqual((row["first"], row["second"], row["contacts"]), ("block", "floor", 4 if is_in_space else 2))
            # The floor pushes back: up the slope on the block, which is -x.
            self.check(row, normal_force=weight * math.cos(angle), force_x=-weight * math.sin(angle), x=0.1 + off, middle_x=0.1)
            if is_in_space:
                self.check(row, tangential_force=weight * math.sin(angle), normal_z=1, eccentricity=off, area=width * depth, y=0,
                           moment_y=-weight * math.cos(angle) * off, moment_x=0, moment_z=0)
            else:
                self.check(row, tangential_force=-weight * math.sin(angle), normal_y=1, eccentricity=off, area=width,
                           moment=weight * math.cos(angle) * off)

    def test_pressed_off_centre(self):
        """A block pressed by a force F and a torque M: the eccentricity is M/F; beyond half the width it turns on its edge."""
        for share, points in ((0.3, 2), (1.01, 1)):
            force, off = 2000.0, share * 0.15
            drives = f'[[drive]]\nbody = "block"\ncomponent = "y"\nkind = "force"\nvalue = {-force}\n' \
                     f'[[drive]]\nbody = "block"\ncomponent = "rotation"\nkind = "force"\nvalue = {-force * off}\n'
            self.run_deck("[scene]\ngravity = [0.0, 0.0]\n" + start(3, 3) + FLOOR + block("block", 0, 0.1, 0.3, 0.2) + drives
                          + "[[interface]]\n")
            row, = self.pairs()
            self.assertEqual(row["contacts"], points)
            if points == 2:
                self.check(row, eccentricity=off, normal_force=force, moment=force * off, tangential_force=0, area=0.3)
            else:
                # It has turned by less than 1e-4 rad, so that the edge has moved by less than 1e-4 of the height.
                self.assertAlmostEqual(row["eccentricity"], 0.15, delta=1e-4)
                self.assertAlmostEqual(row["area"], 0.3, delta=1e-4)

    def test_beam_on_piers(self):
        """A beam that overhangs two piers: their shares by the lever, joints as long as both faces share; names, colours, numbers."""
        piers = "".join(block(f"pier.{i}", x, 0.2, 0.2, 0.4, 'colour = "pier"\nfixed = true\n') for i, x in ((1, -0.5), (2, 0.3)))
        # From -0.55 to 0.45: it covers 0.15 m of the first pier and all of the second. Reactions act at the middles of the joints
        # where these are as stiff as rigid bodies may be: their sum and moment alone are unique.
        beam = block("beam", -0.05, 0.45, 1.0, 0.1, 'colour = "beam"\n')
        weight = 2500 * 0.1 * G
        first = None
        for words in ('between = ["pier.*", "beam"]', 'colours = ["pier", "beam"]', "", "between = [1, 3]\n[[interface]]\nbetween = [2, 3]"):
            self.run_deck("[scene]\n" + start() + piers + beam + "[[interface]]\n" + words + "\n")
            rows = self.pairs()
            self.assertEqual([(row["first"], row["second"]) for row in rows], [("pier.1", "beam"), ("pier.2", "beam")])
            self.assertLessEqual(abs(sum(row["normal_force"] for row in rows) - weight), EXACT * weight)
            self.assertLessEqual(abs(sum(row["normal_force"] * row["x"] for row in rows) + 0.05 * weight), EXACT * weight)
            self.check(rows[0], area=0.15, middle_x=-0.475, normal_y=-1, middle_y=0.4)
            self.check(rows[1], area=0.2, middle_x=0.3)
            first = first or rows
            self.assertEqual(rows, first)
        self.run_deck("[scene]\n" + start() + piers + beam + '[[interface]]\nbetween = ["beam", "pier.2"]\n')
        row, = self.pairs()
        self.assertEqual((row["first"], row["second"]), ("beam", "pier.2"))
        self.check(row, normal_y=1, force_y=-first[1]["force_y"], eccentricity=-first[1]["eccentricity"])

    def test_turned_faces(self):
        """In space faces that cross at 45 degrees share an octagon: 4 (tan(pi/8)) 2 a2 for squares of half side a."""
        turned = block("top", 0, 0.3, 0.2, 0.2, f"rotation = [0.0, 0.0, {math.pi / 4}]\n", 0.2)
        self.run_deck("[scene]\ndimension = 3\n" + start() + SOLID_FLOOR + block("foot", 0, 0.1, 0.2, 0.2, depth=0.2) + turned
                      + '[[interface]]\nbetween = ["top", "foot"]\n')
        row, = self.pairs()
        self.check(row, area=8 * math.tan(math.pi / 8) * 0.1**2, eccentricity=0, normal_force=2500 * 0.2**3 * G)

    def moving_scene(self, is_in_space, steps=120):
        """Grains in a box, all bodies tracked and all pairs measured."""
        if is_in_space:
            box = '[[container]]\nsize = [0.3, 0.3, 0.5]\n'
            # Random polyhedra are hulls.
            shape = '"polyhedron"\nvertices = 12' if self.has_library("Qhull") else '"sphere"'
            grains = f'[[sample]]\nshape = {shape}\nbox = [0.0, 0.0, 0.01, 0.3, 0.3, 0.3]\ncount = 30\nradius = [0.025, 0.03]\n'
            bodies = 35
        else:
            box = FLOOR + '[[wall]]\nname = "left"\nfrom = [-0.01, -0.1]\nto = [-0.01, 1.0]\nthickness = 0.02\n' \
                '[[wall]]\nname = "right"\nfrom = [0.41, -0.1]\nto = [0.41, 1.0]\nthickness = 0.02\n'
            grains = '[[sample]]\nkind = "random"\nshape = "polygon"\nbox = [0.0, 0.0, 0.4, 0.5]\ncount = 40\nradius = [0.02, 0.03]\n'
            bodies = 43
        tracks = "".join(f"[[track]]\nbody = {i + 1}\n" for i in range(bodies))
        return ("[scene]\ndimension = 3\n" if is_in_space else "") + start(steps, 7, 0.4).replace("1e-12", "1e-6") + box + grains \
            + tracks + "[[interface]]\n"

    def test_sums(self):
        """The forces of all pairs on a body add up to the contact force on it, in the plane and in space, also of three subdomains."""
        for is_in_space in (False, True):
            for parts in (1, 3):
                with self.subTest(is_in_space=is_in_space, parts=parts):
                    self.run_deck(self.moving_scene(is_in_space), "--set", f"partition.parts={parts}")
                    sums = {}
                    for row in self.pairs():
                        self.assertNotEqual(row["first"], row["second"])
                        for body, sign in ((row["first"], 1), (row["second"], -1)):
                            for axis in "xyz"[:3 if is_in_space else 2]:
                                key = row["step"], body, axis
                                sums[key] = sums.get(key, 0.0) + sign * row["force_" + axis]
                    largest = max(map(abs, sums.values()))
                    self.assertGreater(len(sums), 100)
                    for row in self.pairs(file="tracks.csv"):
                        for axis in "xyz"[:3 if is_in_space else 2]:
                            self.assertLessEqual(abs(row["force_" + axis] - sums.get((row["step"], row["body"], axis), 0.0)),
                                                 1e-12 * largest)

    def test_restart(self):
        """A run that goes on from a checkpoint writes the very same file; one in stages has their number."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        for is_in_space in (False, True):
            text = self.moving_scene(is_in_space)
            words = ("--set", "restart.every=50", "--set", "restart.at_end=false")
            self.run_deck(text, *words)
            straight = (self.place / "out" / "interfaces.csv").read_bytes()
            self.run_program("run", "deck.toml", "--output", "out", "--quiet", *words, "--restart", "out/restart_a.h5")
            self.assertEqual((self.place / "out" / "interfaces.csv").read_bytes(), straight)
        self.run_deck(self.moving_scene(False) + "[[stage]]\nsteps = 70\n[[stage]]\nsteps = 50\n", output="stages")
        self.assertEqual({row["stage"] for row in self.pairs("stages")}, {1, 2})

    def test_ranks(self):
        """The same bytes on one rank and on three, where the subdomains are the same."""
        if not self.launcher:
            self.skipTest("no MPI")
        texts = []
        for ranks in (1, 3):
            self.on_ranks(ranks, self.moving_scene(False), f"parts{ranks}", "--set", "partition.parts=3")
            texts.append((self.place / f"parts{ranks}" / "interfaces.csv").read_bytes())
        self.assertEqual(*texts)

    def test_mistakes(self):
        """Pairs that make no sense: sentence and place. Without the block there is no file."""
        text = "[scene]\n" + start(1, 1) + FLOOR + block("block", 0, 0.1, 0.3, 0.2)
        for words, sentence in (('between = ["blok", "floor"]', 'there is no body named "blok"; did you mean "block"?'),
                                ('between = ["block", "flo?"]', 'no body has a name that matches "flo?"'),
                                ('between = ["block", 7]', "there is no body 7: the scene has 2"),
                                ('colours = ["grian", "any"]', 'no body has the colour "grian"; did you mean "grain"?'),
                                ('colours = "grain"', '"colours" are the two colours of an interface'),
                                ('between = ["block", "floor"]\ncolours = ["any", "any"]', "drop one of both keys")):
            with self.subTest(words=words):
                self.assertIn(sentence, self.run_deck(text + "[[interface]]\n" + words + "\n", code=2).stderr)
        done = self.run_deck(text + "[[interface]]\n", "--set", "output.record_every=0")
        self.assertIn("[[interface]] has no effect with output.record_every = 0 and output.every = 0", done.stderr)
        self.run_deck(text)
        self.assertFalse((self.place / "out" / "interfaces.csv").exists())

    def test_datbox(self):
        """Next to a DATBOX pairs are called by number, and have what the deck itself gives."""
        text = start() + FLOOR + block("block", 0, 0.1, 0.3, 0.2)
        self.run_deck("[scene]\n" + text + "[[interface]]\nbetween = [1, 2]\n")
        own, = self.pairs()
        self.run_program("convert", "deck.toml", "box")
        self.run_deck('[scene]\ndatbox = "box"\n' + start().split("[[material]]")[0] + "[[interface]]\nbetween = [1, 2]\n")
        other, = self.pairs()
        # Its numbers have eight digits.
        for name in ("normal_force", "area", "x"):
            self.assertAlmostEqual(other[name], own[name], delta=1e-7 * (1 + abs(own[name])))


if __name__ == "__main__":
    take_program()
    unittest.main()
