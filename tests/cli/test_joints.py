#!/usr/bin/env python3
"""Joints from outside: pendulums with closed forms of period, speed and force, a hinge on a slanted axis, a linkage, drift, restarts,
several ranks, and joints that make no sense."""

import csv
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

G = 9.81
START = """[time]
step = {step}
steps = {steps}
[solver]
criterion = "e8"
tolerance = 1e-10
maximum_sweeps = 20000
[output]
record_every = 1
[[material]]
name = "steel"
density = 7800.0
[[law]]
friction = 0.3
[[interaction]]
candidate = "none"
antagonist = "none"
[[body]]
name = "pivot"
colour = "none"
fixed = true
"""
LENGTH = 0.5


def start(step, steps):
    return START.format(step=step, steps=steps) + 'shape = "disk"\nradius = 0.01\nposition = [0.0, 0.0]\n'


def start_in_space(step, steps):
    return "[scene]\ndimension = 3\n" + START.format(step=step, steps=steps) + 'shape = "sphere"\nradius = 0.01\n'


def bar(name, angle, at=(0.0, 0.0), more=""):
    """A bar that hangs from a point at an angle from the vertical, and its joint there."""
    x, y = (at[0] + LENGTH / 2 * math.sin(angle), at[1] - LENGTH / 2 * math.cos(angle))
    a, b = 0.005, LENGTH / 2
    return (f'[[body]]\nname = "{name}"\nshape = "polygon"\nvertices = [[{-a}, {-b}], [{a}, {-b}], [{a}, {b}], [{-a}, {b}]]\n'
            f'position = [{x!r}, {y!r}]\nangle = {angle!r}\n{more}')


def joint(first, second, *point, more=""):
    return f'[[joint]]\nbodies = ["{first}", "{second}"]\npoint = {[float(x) for x in point]}\n{more}'


class Joints(ProgramCase):
    def track(self, body, output="out"):
        return [{name: float(value) for name, value in row.items() if name != "body"} for row in self.rows(output, "tracks.csv")
                if row["body"] == body]

    def test_datbox(self):
        """Next to a DATBOX, whose bodies go by number: the run of the deck itself, on one rank and on two."""
        for is_in_space in (False, True):
            if is_in_space:
                head = start_in_space(1e-3, 60) + 'position = [0.0, 0.0, 0.0]\n[[body]]\nname = "door"\nshape = "box"\n' \
                    'half_axes = [0.2, 0.02, 0.3]\nposition = [0.2, 0.0, 0.0]\n'
                hinge = '[[joint]]\nbodies = [{}, {}]\npoint = [0.0, 0.0, 0.0]\naxis = [0.0, 0.3, 1.0]\nwidth = 0.4\n'
            else:
                head = start(1e-3, 60) + bar("bar", 1.0)
                hinge = "[[joint]]\nbodies = [{}, {}]\npoint = [0.0, 0.0]\n"
            native = head + hinge.format(2, 1) + "[[track]]\nbody = 2\n"
            self.run_deck(native, output="native")
            (self.place / "deck.toml").write_text(head)
            box = f"BOX{int(is_in_space)}"
            self.run_program("convert", "deck.toml", box)
            scene = f'[scene]\ndimension = {2 + is_in_space}\ndatbox = "{box}"\n'
            text = scene + START.format(step=1e-3, steps=60).partition("[[material]]")[0] + hinge.format(2, 1) + "[[track]]\nbody = 2\n"
            self.run_deck(text)
            own, other = self.track("door" if is_in_space else "bar", "native"), self.track("2")
            for name in ("y", "velocity_y", "force_y"):
                # Numbers of a DATBOX have eight digits.
                self.assertAlmostEqual(other[-1][name] / own[-1][name], 1.0, delta=1e-6, msg=name)
            self.assertGreater(abs(own[-1]["velocity_y"]), 1e-2)
            if self.launcher:
                self.on_ranks(2, text, "ranks")
                self.assertAlmostEqual(self.track("2", "ranks")[-1]["y"], other[-1]["y"], delta=1e-9)

    def test_compound_pendulum(self):
        """A bar released from rest: at the horizontal the pivot bears a quarter of its weight, at the lowest point it turns at
        sqrt(3 g/L) and the pivot bears 5/2 of it; the pivot stays in place."""
        step = 5e-4
        self.run_deck(start(step, 900) + bar("bar", math.pi / 2) + joint("bar", "pivot", 0, 0) + '[[track]]\nbody = "bar"\n')
        rows = self.track("bar")
        inertia = (1 + (0.01 / LENGTH) ** 2) / 12 + 0.25  # of the bar about the pivot, over m L^2
        weight = 7800 * 0.01 * LENGTH * G
        # The first step ends at a turn of g h^2: the force has changed by some 1e-5.
        self.assertAlmostEqual(rows[0]["force_y"] / weight, 1 - 0.25 / inertia, delta=1e-4)
        lowest = max(rows, key=lambda row: abs(row["spin"]))
        # The scheme is of second order: (omega h)^2 = 1e-5, and the row nearest to the lowest point is half a step away.
        self.assertAlmostEqual(abs(lowest["spin"]) / math.sqrt(G / (LENGTH * inertia)), 1.0, delta=1e-4)
        self.assertAlmostEqual(lowest["force_y"] / weight, 1 + 0.5 / inertia, delta=1e-2)
        for row in rows:
            way = math.hypot(row["x"] + LENGTH / 2 * math.sin(-row["angle"]), row["y"] + LENGTH / 2 * math.cos(row["angle"]))
            self.assertLess(way, LENGTH * (8 * step) ** 2)
        self.assertLess(float(self.rows()[-1]["energy_closure"]), 1e-9)

    def period(self, rows, name):
        """Time between the first two passages through zero in one sense."""
        passes = [before["time"] + (after["time"] - before["time"]) * before[name] / (before[name] - after[name])
                  for before, after in zip(rows, rows[1:]) if before[name] > 0 >= after[name]]
        return passes[1] - passes[0]

    def test_small_swing(self):
        """Period of a bar, 2 pi sqrt(2 L/(3 g)) and a sixteenth of the square of the swing more."""
        swing = 0.05
        self.run_deck(start(1e-3, 2600) + bar("bar", swing) + joint("bar", "pivot", 0, 0) + '[[track]]\nbody = "bar"\n')
        inertia = (1 + (0.01 / LENGTH) ** 2) / 12 + 0.25
        wanted = 2 * math.pi * math.sqrt(2 * LENGTH * inertia / G) * (1 + swing**2 / 16)
        self.assertAlmostEqual(self.period(self.track("bar"), "angle") / wanted, 1.0, delta=1e-4)

    def test_hinge_on_a_slanted_axis(self):
        """A door whose axis leans by b from the vertical swings as a pendulum under g sin b; it stays on its axis."""
        lean, swing, width, height = 0.6, 0.05, 0.8, 0.6
        # Axes of the door: along the hinge, and across it downwards, in the plane of x and z; the door is turned about y by the lean.
        across = (math.cos(lean), -math.sin(lean))
        # It hangs across the axis, turned by the swing about it: that is a rotation about the axis after one about y.
        axis = (math.sin(lean), 0.0, math.cos(lean))
        centre = [width / 2 * (math.cos(swing) * across[0]), width / 2 * math.sin(swing), width / 2 * math.cos(swing) * across[1]]
        turn = self.rotation(axis, swing, lean)
        door = (f'[[body]]\nname = "door"\nshape = "box"\nhalf_axes = [{width / 2}, 0.01, {height / 2}]\nposition = {centre!r}\n'
                f'rotation = {turn!r}\n[[track]]\nbody = "door"\n')
        self.run_deck(start_in_space(2e-3, 2000) + door + joint("door", "pivot", 0, 0, 0, more=f"axis = {list(axis)!r}\nwidth = 0.5\n"))
        rows = self.track("door")
        inertia = (1 + (0.02 / width) ** 2) / 12 + 0.25
        wanted = 2 * math.pi * math.sqrt(2 * width * inertia / (G * math.sin(lean))) * (1 + swing**2 / 16)
        self.assertAlmostEqual(self.period(rows, "y") / wanted, 1.0, delta=1e-3)
        for row in rows:
            along = row["x"] * axis[0] + row["z"] * axis[2]
            self.assertAlmostEqual(along, 0.0, delta=1e-5)
            self.assertAlmostEqual(math.sqrt(row["x"] ** 2 + row["y"] ** 2 + row["z"] ** 2), width / 2, delta=1e-5)

    @staticmethod
    def rotation(axis, swing, lean):
        """The vector of the rotation about an axis after one by `lean` about y that brings x to across and z to the axis."""
        def product(p, q):
            (a, *u), (b, *v) = p, q
            return (a * b - sum(x * y for x, y in zip(u, v)), *(a * v[k] + b * u[k] + u[(k + 1) % 3] * v[(k + 2) % 3]
                                                              - u[(k + 2) % 3] * v[(k + 1) % 3] for k in range(3)))
        first = (math.cos(lean / 2), 0.0, math.sin(lean / 2), 0.0)
        second = (math.cos(swing / 2), *(math.sin(swing / 2) * x for x in axis))
        whole, *vector = product(second, first)
        size = math.sqrt(sum(x * x for x in vector))
        return [2 * math.atan2(size, whole) * x / size for x in vector]

    def chain(self, steps=200):
        """Three bars in a row, the first one on the pivot: a linkage that whips."""
        text = start(1e-3, steps)
        for i in range(3):
            text += bar(f"bar.{i}", math.pi / 2, (i * LENGTH, 0.0)) + joint(f"bar.{i}", f"bar.{i - 1}" if i else "pivot", i * LENGTH, 0)
        return text + '[[track]]\nbody = "bar.*"\n'

    def test_linkage(self):
        """Joints of a linkage hold, its energy is that of the fall, and a restart goes on bit for bit; on three ranks it is the same."""
        self.run_deck(self.chain(400))
        rows = [self.track(f"bar.{i}") for i in range(3)]
        for moment in zip(*rows):
            for i, row in enumerate(moment):
                ends = [(row["x"] + side * LENGTH / 2 * math.sin(row["angle"]), row["y"] - side * LENGTH / 2 * math.cos(row["angle"]))
                        for side in (-1, 1)]
                if i:
                    self.assertLess(math.dist(ends[0], last), 2e-4)
                last = ends[1]
        record = [{name: float(row[name]) for name in ("kinetic_energy", "potential_energy")} for row in self.rows()]
        fallen = record[0]["potential_energy"] - record[-1]["potential_energy"]
        self.assertGreater(fallen, 10.0)
        self.assertAlmostEqual((record[-1]["kinetic_energy"] - record[0]["kinetic_energy"]) / fallen, 1.0, delta=5e-3)
        if self.launcher:
            self.on_ranks(3, self.chain(), "ranks")
            self.run_deck(self.chain(), output="alone")
            for body in ("bar.0", "bar.2"):
                for a, b in zip(self.track(body, "alone"), self.track(body, "ranks"), strict=True):
                    self.assertAlmostEqual(a["angle"], b["angle"], delta=1e-6)
        if not self.has_hdf5():
            return
        words = ("--set", "restart.every=150", "--set", "restart.at_end=false")
        self.run_deck(self.chain(), *words)
        straight = (self.place / "out" / "tracks.csv").read_bytes()
        self.run_program("run", "deck.toml", "--output", "out", "--quiet", *words, "--restart", "out/restart_a.h5")
        self.assertEqual((self.place / "out" / "tracks.csv").read_bytes(), straight)

    def test_mistakes(self):
        """Bodies that are not there or one, an axis of no length or no width: sentence and place."""
        text = start_in_space(1e-3, 1) + '[[body]]\nname = "ball"\nshape = "sphere"\nradius = 0.1\nposition = [1.0, 0.0, 0.0]\n'
        for words, sentence in ((joint("ball", "pivt", 0, 0, 0), 'there is no body named "pivt"; did you mean "pivot"?'),
                                (joint("ball", "ball", 0, 0, 0), "a joint needs two different bodies"),
                                (joint("ball", "pivot", 0, 0, 0, more="axis = [0.0, 0.0, 0.0]\nwidth = 0.1\n"), "axis of a hinge must not be zero"),
                                (joint("ball", "pivot", 0, 0, 0, more="axis = [0.0, 0.0, 1.0]\n"), 'a hinge needs a "width"'),
                                (joint("ball", "pivot", 0, 0, 0, more="width = 0.1\n"), '"width" has no meaning without "axis"')):
            with self.subTest(words=words):
                self.assertIn(sentence, self.run_deck(text + words, code=2).stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
