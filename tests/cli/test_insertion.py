#!/usr/bin/env python3
"""Bodies that enter and leave: `at`, [[rain]], [[remove]]. Closed forms, balances, restarts, ranks, pictures, bad input.

usage: test_insertion.py PROGRAM MPIEXEC [unittest options]
"""

import sys
import unittest
from math import ceil, floor, pi, sqrt
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

HEAD = """[time]
step = 1e-3
steps = {steps}
[solver]
method = "nlgs"
criterion = "e8"
tolerance = 1e-12
[output]
record_every = 1
[scene]
dimension = {dimension}
gravity = {gravity}
[[material]]
name = "stone"
density = 1000.0
[[law]]
friction = 0.3
"""
TRACK = """[[track]]
body = "*"
"""
GRAVITY = {2: [0.0, -10.0], 3: [0.0, 0.0, -10.0]}
UP = {2: "y", 3: "z"}
MASS = {2: 1000 * pi * 0.1**2, 3: 1000 * 4 / 3 * pi * 0.1**3}
ROUNDING = 1e-12
"""Places, velocities and energies after some hundred steps, relative to the largest: rounding of each is 1e-16."""
# A pile that a rain makes, and from which grains leave at its sides.
PILE = """[[wall]]
name = "floor"
from = [-0.15, -0.01]
to = [0.15, -0.01]
thickness = 0.02
[[rain]]
box = [-0.1, 0.15, 0.1, 0.25]
count = 60
rate = 200.0
radius = [0.015, 0.02]
velocity = [0.0, -2.0]
every = 2
[[remove]]
box = [-1.0, -0.05, 1.0, 1.0]
every = 3
"""


def place(dimension, across, height):
    """A point of the plane, or of space, as a list."""
    return [across, height] if dimension == 2 else [across, 0.0, height]


def ball(dimension, name, across, height=0.0, more=""):
    shape = "disk" if dimension == 2 else "sphere"
    return f'[[body]]\nname = "{name}"\nshape = "{shape}"\nradius = 0.1\nposition = {place(dimension, across, height)}\n{more}'


def box(dimension, across, height):
    """A box from ranges across and in height."""
    if dimension == 2:
        return [across[0], height[0], across[1], height[1]]
    return [across[0], -1.0, height[0], across[1], 1.0, height[1]]


class Insertion(ProgramCase):
    def write(self, body, steps=400, dimension=2, name="deck", track=True):
        head = HEAD.format(steps=steps, dimension=dimension, gravity=GRAVITY[dimension])
        (self.place / f"{name}.toml").write_text(head + (TRACK if track else "") + body)

    def column(self, name, output="out"):
        return [float(row[name]) for row in self.rows(output)]

    def track(self, body, name, output="out"):
        return [float(row[name]) for row in self.rows(output, "tracks.csv") if row["body"] == body]

    def test_body_that_leaves(self):
        """A ball that falls into a box leaves at the step after, and mass and momentum of the grains fall by its own; another one
        stays. The energy balance stays closed."""
        for dimension in (2, 3):
            with self.subTest(dimension=dimension):
                up, mass = UP[dimension], MASS[dimension]
                self.write(ball(dimension, "gone", 0.0) + ball(dimension, "kept", 1.0)
                           + f'[[remove]]\nbox = {box(dimension, (-0.5, 0.5), (-9.0, -0.2))}\nwhere = "inside"\n', 300, dimension)
                self.call()
                # After step n it is at - g (n h)^2/2, which is below - 0.2 m from step 200 on: it leaves before step 201, or 202 by rounding.
                gone = next(i for i, row in enumerate(self.rows(), 1) if row["removed"] == "1")
                self.assertIn(gone, (201, 202))
                for step, value in enumerate(self.column(f"momentum_{up}"), 1):
                    self.assertAlmostEqual(value, -10 * step * 1e-3 * mass * (2 if step < gone else 1), delta=ROUNDING * mass * 10)
                self.assertAlmostEqual(self.column("mass_removed")[-1], mass, delta=ROUNDING * mass)
                self.assertAlmostEqual(self.column("kinetic_energy")[-1], mass * 3.0**2 / 2, delta=ROUNDING * mass * 10)
                self.assertAlmostEqual(self.column("potential_energy")[-1], -mass * 3.0**2 / 2, delta=ROUNDING * mass * 10)
                self.assertLess(max(self.column("energy_closure")[1:]), ROUNDING)
                self.assertEqual(self.track("gone", f"velocity_{up}")[-1], 0.0)
                self.assertEqual(self.track("gone", up)[gone - 2 :], [self.track("gone", up)[gone - 2]] * (302 - gone))
                self.assertAlmostEqual(self.track("kept", up)[-1], -10 * 0.3**2 / 2, delta=ROUNDING)

    def test_body_that_enters(self):
        """A ball that enters at 0.1 s with a velocity: before it neither moves nor counts nor touches what falls through its place;
        from then on its path is that of a throw."""
        for dimension in (2, 3):
            with self.subTest(dimension=dimension):
                up, mass = UP[dimension], MASS[dimension]
                thrown = f"velocity = {place(dimension, 0.5, 1.0)}\nat = 0.1\n"
                self.write(ball(dimension, "late", 2.0, more=thrown) + ball(dimension, "first", 2.0, 0.01), 300, dimension)
                self.call("--set", "body[1].at=0.3")
                self.assertEqual(set(self.column("contacts")), {0.0})
                self.assertAlmostEqual(self.track("first", up)[-1], 0.01 - 0.45, delta=ROUNDING)
                self.write(ball(dimension, "late", 2.0, more=thrown) + ball(dimension, "first", 0.0), 300, dimension)
                self.call()
                for step, (across, height) in enumerate(zip(self.track("late", "x"), self.track("late", up), strict=True), 1):
                    time = max(0.0, step * 1e-3 - 0.1)
                    self.assertAlmostEqual(across, 2 + 0.5 * time, delta=ROUNDING)
                    self.assertAlmostEqual(height, time - 5 * time**2, delta=ROUNDING)
                self.assertEqual(self.column("waiting"), [1.0] * 100 + [0.0] * 200)
                self.assertEqual(self.column("mass_entered")[98:101:2], [0.0, self.column("mass_entered")[-1]])
                self.assertAlmostEqual(self.column("mass_entered")[-1], mass, delta=ROUNDING * mass)
                self.assertLess(max(self.column("energy_closure")[1:]), ROUNDING)

    def test_wall_that_enters(self):
        """A ball is below the place of a floor when that enters, another one above it, which comes to rest there."""
        for dimension, floor in ((2, "from = [-0.5, -0.01]\nto = [3.5, -0.01]"),
                                 (3, "centre = [1.0, 0.0, 0.0]\nsize = [4.0, 1.0]")):  # fmt: skip
            with self.subTest(dimension=dimension):
                up = UP[dimension]
                self.write(ball(dimension, "low", 0.0, 0.1) + ball(dimension, "high", 1.0, 0.5)
                           + f'[[wall]]\nname = "floor"\n{floor}\nthickness = 0.02\nat = 0.25\n', 500, dimension)  # fmt: skip
                self.call()
                self.assertAlmostEqual(self.track("low", up)[-1], 0.1 - 5 * 0.5**2, delta=ROUNDING)
                self.assertEqual(self.column("contacts")[:250], [0.0] * 250)
                # The floor catches it within the alert distance of a step, and it stays to the digits of the solver.
                self.assertAlmostEqual(self.track("high", up)[-1], 0.1, delta=3e-3)
                self.assertAlmostEqual(self.track("high", f"velocity_{up}")[-1], 0.0, delta=1e-9)
                # It is no grain, and counts as none.
                self.assertEqual([set(self.column(name)) for name in ("waiting", "entered")], [{0.0}, {0.0}])
                # In the first steps works are small next to the potential energies, whose rounding they hold.
                self.assertLess(max(self.column("energy_closure")[10:]), ROUNDING)

    def test_driven_body(self):
        """A plate that enters at 0.1 s and is driven downwards from then on: it stays where it waits, moves as it is driven, pushes a
        ball, is no grain; the balance stays closed."""
        plate = ('[[body]]\nname = "plate"\nshape = "polygon"\nvertices = [[-0.5, -0.1], [0.5, -0.1], [0.5, 0.1], [-0.5, 0.1]]\n'
                 'position = [0.0, 0.5]\nvelocity = [0.0, -1.0]\nat = 0.1\n')  # fmt: skip
        drives = "".join(f'[[drive]]\nbody = "plate"\ncomponent = "{c}"\nvalue = {v}\n' for c, v in (("x", 0.0), ("y", -1.0), ("rotation", 0.0)))
        for words in ((), ("--set", "partition.parts=2")):
            self.write(plate + drives + ball(2, "ball", 0.0) + ball(2, "other", 3.0), 500)
            self.call("--set", "scene.gravity=[0.0, 0.0]", *words)
            for step, height in enumerate(self.track("plate", "y"), 1):
                self.assertAlmostEqual(height, 0.5 - max(0.0, step * 1e-3 - 0.1), delta=ROUNDING)
            # It touches the ball when it is 0.2 m above it.
            self.assertAlmostEqual(self.track("ball", "velocity_y")[-1], -1.0, delta=ROUNDING)
            self.assertEqual([any(n > 0 for n in self.column("contacts")[:380]), self.column("contacts")[-1]], [False, 1.0])
            self.assertAlmostEqual(self.column("kinetic_energy")[-1], (200 + MASS[2]) / 2, delta=ROUNDING * 1000)
            self.assertAlmostEqual(self.column("momentum_y")[-1], -MASS[2], delta=ROUNDING * 1000)
            self.assertLess(max(self.column("energy_closure")[1:]), ROUNDING)

    def test_gate(self):
        """A ball that rests on a wall falls when the wall is taken away."""
        for dimension, gate in ((2, "from = [-0.5, -0.01]\nto = [0.5, -0.01]"),
                                (3, "centre = [0.0, 0.0, 0.0]\nsize = [1.0, 1.0]")):  # fmt: skip
            with self.subTest(dimension=dimension):
                up = UP[dimension]
                self.write(f'[[wall]]\nname = "gate"\n{gate}\nthickness = 0.02\n' + ball(dimension, "ball", 0.0, 0.1)
                           + '[[remove]]\nbody = "ga*"\nat = 0.1\n', 300, dimension)  # fmt: skip
                self.call()
                for step, height in enumerate(self.track("ball", up), 1):
                    self.assertAlmostEqual(height, 0.1 - 5 * max(0.0, step * 1e-3 - 0.1) ** 2, delta=ROUNDING)
                self.assertEqual(self.column("contacts"), [1.0] * 100 + [0.0] * 200)
                self.assertEqual(self.column("removed")[-1], 0.0)

    def test_beside_a_datbox(self):
        """A disk of an LMGC90 scene is removed, a rain of the deck falls into it; what a DATBOX cannot hold is not written as one."""
        folder = Path(__file__).resolve().parents[1] / "decks/datbox_piston/DATBOX"
        deck = f'[scene]\ndatbox = "{folder}"\n[time]\nstep = 5e-4\nsteps = 60\n[output]\nrecord_every = 1\n'
        (self.place / "deck.toml").write_text(deck + "[[remove]]\nbody = 1\nat = 0.01\n")
        self.call()
        self.assertEqual(self.column("removed"), [0.0] * 20 + [1.0] * 40)
        self.assertLess(max(self.column("energy_closure")[1:]), ROUNDING)
        rain = "[[rain]]\nbox = [-0.5, 3.0, 0.5, 4.0]\ncount = 5\nrate = 200.0\nradius = 0.01\nvelocity = [0.0, -20.0]\n"
        (self.place / "deck.toml").write_text(deck + rain + '[[interaction]]\nlaw = "rough"\n')
        self.call()
        self.assertEqual((self.column("entered")[-1], self.column("waiting")[-1]), (5.0, 0.0))
        self.assertLess(max(self.column("energy_closure")[1:]), ROUNDING)
        self.write(PILE)
        said = self.run_program("convert", "deck.toml", "folder", code=2).stderr
        self.assertIn("bodies enter or leave in this scene", said)

    def test_rate_of_a_rain(self):
        """In a wide window grains enter at the rate, at the looks that there are. In one as wide as a grain, each waits until the one
        before has fallen by a diameter."""
        for dimension in (2, 3):
            for every in (1, 7):
                with self.subTest(dimension=dimension, every=every):
                    # One grain after 20 ms, ten radii lower than the one before: none is in the place of another.
                    self.write(f"[[rain]]\nbox = {box(dimension, (0.0, 0.4), (0.0, 0.04))}\ncount = 12\nrate = 50.0\nradius = 0.01\nevery = {every}\n"
                               f"velocity = {place(dimension, 0.0, -5.0)}\n", 300, dimension, track=False)
                    self.call()
                    self.assertEqual(self.column("contacts")[-1], 0.0)
                    for step, entered in enumerate(self.column("entered"), 1):
                        look = every * ((step - 1) // every)
                        self.assertEqual(entered, min(12, floor(50 * look * 1e-3 + 1e-6) + 1), step)
                    self.write(f"[[rain]]\nbox = {box(dimension, (0.0, 0.02), (0.0, 0.02))}\ncount = 12\nrate = 1e4\nradius = 0.01\nevery = {every}\n"
                               .replace("-1.0", "0.0").replace(", 1.0, ", ", 0.02, "), 400, dimension, track=False)
                    self.call()
                    # A fall of 2 r takes sqrt(4 r/g), rounded up to a look.
                    gap = every * ceil(ceil(sqrt(4 * 0.01 / 10) / 1e-3) / every)
                    self.assertEqual(self.column("entered"), [min(12.0, 1.0 + (step - 1) // gap) for step in range(1, 401)])
                    self.assertLess(max(self.column("energy_closure")[1:]), ROUNDING)

    def test_stages(self):
        """Bodies and grains that enter with a stage, and a gate that leaves with another."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no stages")
        self.write('[[stage]]\nname = "one"\nsteps = 30\n[[stage]]\nname = "two"\nsteps = 500\nuntil = "time > 0.0505"\n'
                   '[[stage]]\nname = "three"\nsteps = 40\n' + ball(2, "late", 0.0, more='at = "two"\n') + ball(2, "first", 5.0)
                   + ball(2, "last", 1.0, more='at = "three"\n') + ball(2, "there", 2.0, more='at = "one"\n')
                   + '[[sample]]\nkind = "lattice"\nbox = [3.0, 0.0, 3.1, 0.1]\nradius = 0.01\nat = "three"\n'
                   '[[remove]]\nbody = "first"\nat = "two"\n')  # fmt: skip
        deck = self.place / "deck.toml"
        deck.write_text(deck.read_text().replace("steps = 400\n", ""))
        self.call()
        ends = [30, 51, 91]
        n = self.column("waiting")[0] - 2
        self.assertEqual(self.column("entered")[-1], n + 3)
        self.assertEqual(self.column("waiting"), [n + 2.0] * 30 + [n + 1.0] * 21 + [0.0] * 40)
        self.assertEqual(self.column("removed"), [0.0] * 30 + [1.0] * 61)
        for name, start in (("there", 0), ("late", ends[0]), ("last", ends[1])):
            self.assertAlmostEqual(self.track(name, "y")[-1], -5 * ((ends[2] - start) * 1e-3) ** 2, delta=ROUNDING)
        rows = self.rows()
        for step in (20, 30, 40, 60):
            with self.subTest(step=step):
                self.call("--set", f"time.steps={step}", output="parts")
                self.call("--restart", "parts", output="parts")
                self.assertEqual(self.rows("parts"), rows)

    def test_places_of_later_stages(self):
        """A body may be drawn where another one is at the start; two that enter together may not overlap."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no stages")
        stages = '[[stage]]\nname = "one"\nsteps = 30\n[[stage]]\nname = "two"\nsteps = 10\n[[stage]]\nname = "three"\nsteps = 10\n'
        for dimension in (2, 3):
            with self.subTest(dimension=dimension):
                fast = ball(dimension, "first", 0.0, more=f"velocity = {place(dimension, 10.0, 0.0)}\n")
                late = ball(dimension, "late", 0.0, more='at = "two"\n')
                self.write(stages + fast + late, dimension=dimension)
                deck = self.place / "deck.toml"
                deck.write_text(deck.read_text().replace("steps = 400\n", ""))
                self.call()
                self.assertEqual(self.column("entered")[-1], 1)
                deck.write_text(deck.read_text() + ball(dimension, "twin", 0.15, more='at = "two"\n'))
                said = self.call(code=2).stderr
                self.assertIn('"late" and "twin" overlap at the start', said)
                self.assertNotIn("first", said)

    def test_restart(self):
        """A run that goes on from a checkpoint is, digit by digit, the run that never ended; before, between and after entries."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        self.write(PILE, 600, track=False)
        self.call()
        rows = self.rows()
        self.assertEqual(float(rows[-1]["entered"]), 60)
        self.assertGreater(float(rows[-1]["removed"]), 5)
        self.assertLess(max(self.column("energy_closure")[1:]), ROUNDING)
        for step in (1, 100, 333):
            with self.subTest(step=step):
                self.call("--set", f"time.steps={step}", output="parts")
                self.call("--restart", "parts", output="parts")
                self.assertEqual(self.rows("parts"), rows)

    def test_restart_of_another_deck(self):
        """What was removed stays so in a deck that removes nothing; bodies of a run in which all were there are there."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        balls = ball(2, "gone", 0.0) + ball(2, "kept", 1.0)
        self.write(balls + '[[remove]]\nbody = "gone"\nat = 0.05\n', 100)
        self.write(balls, 200, name="plain")
        self.write(balls.replace('"kept"', '"kept"\nat = 0.5'), 300, name="later")
        self.call()
        self.call("--restart", "out", deck="plain")
        self.assertEqual(self.column("removed"), [0.0] * 50 + [1.0] * 150)
        self.assertEqual(self.track("gone", "y")[49:], [self.track("gone", "y")[49]] * 151)
        self.assertAlmostEqual(self.track("kept", "y")[-1], -5 * 0.2**2, delta=ROUNDING)
        self.call(deck="plain", output="plain")
        self.assertNotIn("removed", self.rows("plain")[0])
        self.call("--restart", "plain", deck="later", output="later")
        self.assertAlmostEqual(self.track("kept", "y", "later")[-1], -5 * 0.3**2, delta=ROUNDING)
        self.assertEqual(set(self.column("waiting", "later")), {0.0})

    def test_ranks(self):
        """On two ranks and on three subdomains bodies enter at the steps of one rank as long as none has touched another; the balance
        stays closed; two subdomains of one process are two ranks, digit by digit."""
        self.write(PILE, 250, track=False)
        few = ("--set", "solver.tolerance=1e-6")
        self.call(*few)
        one = self.column("entered")
        ways = [("parts", ("--set", "partition.parts=2"), 1), ("three", ("--set", "partition.parts=3"), 1)]
        for output, words, ranks in ways + ([("two", (), 2)] if self.launcher else []):
            with self.subTest(output=output):
                self.call(*few, *words, output=output, ranks=ranks)
                first = next(i for i, n in enumerate(self.column("contacts")) if n > 0)
                self.assertEqual(self.column("entered", output)[:first], one[:first])
                # Digits differ, and paths with them: how many are in a place does by some.
                for name, margin in (("entered", 5), ("removed", 5)):
                    self.assertLess(abs(self.column(name, output)[-1] - self.column(name)[-1]), margin, name)
                self.assertLess(max(self.column("energy_closure", output)[1:]), ROUNDING)
        if self.launcher:
            self.assertEqual(self.rows("parts"), self.rows("two"))
        gate = '[[wall]]\nname = "gate"\nfrom = [-0.5, -0.01]\nto = [2.5, -0.01]\nthickness = 0.02\n[[remove]]\nbody = "gate"\nat = 0.1\n'
        self.write(gate + "".join(ball(2, f"ball{i}", 0.3 * i, 0.1) for i in range(6)) + ball(2, "late", 2.1, 0.1, "at = 0.2\n"), 300)
        self.call("--set", "partition.parts=2")
        for i in range(6):
            self.assertAlmostEqual(self.track(f"ball{i}", "y")[-1], 0.1 - 5 * 0.2**2, delta=ROUNDING)
        self.assertAlmostEqual(self.track("late", "y")[-1], 0.1 - 5 * 0.1**2, delta=ROUNDING)

    def test_restart_on_ranks(self):
        """A checkpoint of two subdomains goes on on one, and the other way round: who is there stays so."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        self.write(PILE, 250, track=False)
        for before, after in (("2", "0"), ("0", "2"), ("2", "3")):
            with self.subTest(before=before, after=after):
                few = ("--set", "solver.tolerance=1e-6", "--set")
                self.call("--set", "time.steps=125", *few, f"partition.parts={before}")
                self.call("--restart", "out", *few, f"partition.parts={after}")
                for name in ("entered", "removed"):
                    values = self.column(name)
                    self.assertEqual(values, sorted(values))
                self.assertGreater(self.column("entered")[-1], self.column("entered")[124])
                self.assertLess(max(self.column("energy_closure")[1:]), 1e-11)

    def test_pictures(self):
        """Absent bodies are marked in pictures, for VTK too; a run without entries and exits has no such arrays."""
        try:
            import h5py
        except ImportError:
            self.skipTest("no h5py")
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 writes no pictures")
        balls = ball(2, "late", 0.0, more="at = 0.1\n") + ball(2, "gone", 1.0)
        for words in ((), ("--set", "partition.parts=2")):
            self.write(balls + '[[remove]]\nbody = "gone"\nat = 0.2\n', 300)
            self.call("--set", "output.every=90", *words)
            for file, group, hidden in (("bodies", "PointData", 2), ("shapes", "CellData", 32)):
                with h5py.File(self.place / f"out/{file}.vtkhdf") as grid:
                    arrays = grid[f"VTKHDF/{group}"]
                    self.assertEqual(arrays["is_present"][:].reshape(-1, 2).tolist(), [[0, 1], [0, 1], [1, 1], [1, 0], [1, 0]])
                    self.assertEqual(arrays["vtkGhostType"][:].reshape(-1, 2).tolist(), [[hidden, 0]] * 2 + [[0, 0]] + [[0, hidden]] * 2)
                    self.assertEqual(arrays["vtkGhostType"].dtype, "uint8")
        self.write(balls.replace("at = 0.1\n", ""), 10)
        self.call("--set", "output.every=5")
        with h5py.File(self.place / "out/bodies.vtkhdf") as grid:
            self.assertNotIn("is_present", grid["VTKHDF/PointData"])

    def test_bad_input(self):
        """One sentence each, at its place."""
        rain = "[[rain]]\nbox = [0.0, 0.0, 1.0, 1.0]\ncount = 3\nrate = 1.0\nradius = 0.1\n"
        for body, words, where in (
            ("[[remove]]\nevery = 3\n", 'a [[remove]] needs the key "box" or "at"', "[[remove]]"),
            ("[[remove]]\nbox = [0.0, 0.0, 0.0, 1.0]\n", "the box is empty", "box = "),
            ("[[remove]]\nat = 0.1\nbody = 'bal'\n", 'there is no body named "bal"', "body = 'bal'"),
            ("[[remove]]\nat = 0.1\nbody = 7\n", "there is no body 7: the scene has 1", "body = 7"),
            ("[[remove]]\nat = 0.1\nwhere = 'inside'\n", '"where"', "where ="),
            ("[[remove]]\nat = 'later'\n", 'there is no stage named "later"', "at = 'later'"),
            ("[[remove]]\nat = -1.0\n", '"at" must be at least 0', "at = -1.0"),
            ("[[remove]]\nat = [1.0, 2.0]\n", "must be a time or the name of a stage", "at = ["),
            (rain.replace("radius = 0.1", "radius = 0.6"), "the window is too narrow for grains of a radius of 6.000E-01 m", "box ="),
            ('[[wall]]\nfrom = [0.0, 0.5]\nto = [1.0, 0.5]\nthickness = 0.02\n' + rain.replace("1.0, 1.0]", "1.0, 0.6]"),
             "overlap at the start by", "[[rain]]"),
            (rain.replace("radius = 0.1\n", ""), 'one of the keys "radius", "sieve" and "curve"', "[[rain]]"),
            (rain.replace("rate = 1.0\n", ""), 'lacks the key "rate"', "[[rain]]"),
            (rain.replace("rate = 1.0", "rate = 0.0"), '"rate" must be larger than 0', "rate ="),
        ):  # fmt: skip
            with self.subTest(words=words):
                self.write(ball(2, "ball", 0.0) + body)
                text = (self.place / "deck.toml").read_text().splitlines()
                line = max(i for i, text_line in enumerate(text, 1) if text_line.startswith(where))
                said = self.call(code=2).stderr
                self.assertIn(words, said)
                self.assertRegex(said, rf"deck.toml:{line}:\d+: error: ")


if __name__ == "__main__":
    take_program()
    unittest.main()
