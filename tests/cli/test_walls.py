#!/usr/bin/env python3
"""Walls and the cell that they enclose, from outside: weight on a floor, a pressed plate, strains of a driven lid, restarts to the
byte, several ranks, a DATBOX."""

import csv
import json
import math
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

G = 9.81
START = """[scene]
dimension = {dimension}
gravity = {gravity}
[time]
step = 1e-3
steps = {steps}
[solver]
criterion = "e8"
tolerance = 1e-12
[output]
record_every = {every}
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.3
"""
# Of the solver (1e-12 of the largest impulse) over a sum of a few contacts.
EXACT = 1e-9


def start(dimension, steps=100, every=10, weighs=True):
    gravity = [0.0] * (dimension - 1) + [-G * weighs]
    return START.format(dimension=dimension, gravity=gravity, steps=steps, every=every)


def wall(name, first, second, more=""):
    return f'[[wall]]\nname = "{name}"\nfrom = {first}\nto = {second}\nthickness = 0.1\n{more}'


def sphere(x, y, z):
    return f'[[body]]\nshape = "sphere"\nradius = 0.05\nposition = [{x}, {y}, {z}]\n'


def disk(x, y):
    return f'[[body]]\nshape = "disk"\nradius = 0.05\nposition = [{x}, {y}]\n'


BOX = '[[container]]\nsize = [0.4, 0.3, 0.2]\nlid = true\n'


class Walls(ProgramCase):
    def rows(self, wall=None, output="out"):
        with (self.place / output / "walls.csv").open(newline="") as file:
            rows = [{name: value if name == "wall" else float(value) for name, value in row.items()} for row in csv.DictReader(file)]
        return [row for row in rows if wall in (None, row["wall"])]

    def record(self, output="out"):
        with (self.place / output / "record.csv").open(newline="") as file:
            return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]

    def run_json(self, output="out"):
        return json.loads((self.place / output / "run.json").read_text())

    def near(self, got, wanted, scale=1.0):
        self.assertLessEqual(abs(got - wanted), EXACT * scale, f"{got} is not {wanted}")

    def test_weight(self):
        """Spheres at rest: the floor carries their weight, sides and lid nothing; the room is a cell."""
        spheres = [(0.1, 0.15, 0.05), (0.3, 0.1, 0.05), (0.25, 0.23, 0.05)]
        self.run_deck(start(3) + BOX + "".join(sphere(*at) for at in spheres))
        weight = 3 * 2500 * 4 / 3 * math.pi * 0.05**3 * G
        self.assertEqual(len(self.rows()), 6 * 10)
        self.assertEqual(self.run_json()["file_walls"], "walls.csv")
        for row in self.rows("box.floor"):
            for name, wanted in {"force_x": 0, "force_y": 0, "force_z": -weight, "mean_force_z": -weight,
                                 "pressure": weight / 0.12, "mean_pressure": weight / 0.12}.items():
                self.near(row[name], wanted, weight / 0.12)
            self.near(row["area"], 0.12)
            self.assertEqual(row["contacts"], 3)
        for name in ("box.left", "box.right", "box.front", "box.back", "box.lid"):
            self.near(self.rows(name)[-1]["pressure"], 0, weight / 0.12)
        volume = 3 * 4 / 3 * math.pi * 0.05**3
        for row in self.record():
            self.near(row["cell_x"], 0.4)
            self.near(row["cell_y"], 0.3)
            self.near(row["strain_zz"], 0)
            self.near(row["void_ratio"], 0.024 / volume - 1)
        self.near(self.run_json()["void_ratio"], 0.024 / volume - 1)

    def plate(self, steps=100, more=""):
        """A wall pressed by 10 kPa on 5 by 3 disks between two others, nothing weighs: each column carries a fifth."""
        walls = wall("floor", [-0.1, -0.05], [0.6, -0.05]) + wall("left", [-0.05, -0.1], [-0.05, 0.5])
        walls += wall("right", [0.55, -0.1], [0.55, 0.5])
        walls += wall("plate", [-0.1, 0.35], [0.6, 0.35], 'pressure = 1e4\ndirection = [0, -1]\nbetween = ["left", "right"]\n')
        return start(2, steps, weighs=False) + walls + "".join(disk(0.05 + 0.1 * i, 0.05 + 0.1 * k) for i in range(5) for k in range(3)) \
            + more

    def test_pressed_plate(self):
        """At rest the pressure is the prescribed one, on the plate and on the floor below."""
        self.run_deck(self.plate())
        for name in ("plate", "floor"):
            for row in self.rows(name):
                self.near(row["area"], 0.5)
                self.near(row["pressure"], 1e4, 1e4)
                self.near(row["mean_pressure"], 1e4, 1e4)
        for row in self.record():
            self.near(row["fabric_yy"], 1)
            self.near(row["fabric_xx"], 0)
            self.near(row["stress_yy"], 1e4, 1e4)
            # Five columns: ten contacts of grains, ten with walls.
            self.near(row["grain_coordination"], 2 * 10 / 15)
            self.near(row["wall_coordination"], 10 / 15)

    def test_driven_lid(self):
        """A lid that comes down by 0.2 m/s on nothing: logarithmic strain, void ratio, end condition."""
        drive = '[[drive]]\nbody = "box.lid"\ncomponent = "z"\nvalue = -0.2\n[stop]\nwhen = "strain_zz > 0.25"\n'
        self.run_deck(start(3, 1000, 1, weighs=False) + BOX + sphere(0.2, 0.15, 0.05) + drive)
        volume = 4 / 3 * math.pi * 0.05**3
        for row in self.record():
            # The mid-point rule has half of the velocity in the first step.
            height = 0.2 - 0.2 * (row["time"] - 0.5e-3)
            self.near(row["cell_z"], height)
            self.near(row["strain_zz"], math.log(0.2 / height))
            self.near(row["strain_xx"], 0)
            self.near(row["void_ratio"], 0.12 * height / volume - 1, 0.12 * height / volume)
        height = 0.2 * math.exp(-0.25)
        self.assertEqual(self.run_json()["steps"], math.floor((0.2 - height) / 0.2e-3 + 0.5) + 1)
        for side in self.rows("box.left"):
            self.near(side["area"], 0.3 * (0.2 - 0.2 * (side["time"] - 0.5e-3)))

    def test_open_box(self):
        """Without a lid there is no cell; a wall of its own has its own size, and one in the plane two sides."""
        self.run_deck(start(3) + BOX.replace("lid = true", "lid = false") + sphere(0.2, 0.15, 0.05))
        self.assertNotIn("void_ratio", self.record()[0])
        self.near(self.rows("box.floor")[0]["area"], 0.12)
        ceiling = wall("shelf", [0.6, 0.0], [-0.4, 0.0])
        self.run_deck(start(2) + ceiling + disk(0.0, 0.1), "--force")
        row = self.rows("shelf")[-1]
        weight = 2500 * math.pi * 0.05**2 * G
        self.near(row["area"], 1.0)
        self.near(row["pressure"], weight, weight)
        self.run_deck(start(2) + ceiling + disk(0.0, 0.1), "--force", "--set", "output.record_every=0")
        self.assertFalse((self.place / "out" / "walls.csv").exists())

    def shaken(self, is_in_space, steps=200):
        """Grains in a cell whose walls move."""
        if is_in_space:
            text = BOX.replace("0.4, 0.3, 0.2", "0.3, 0.3, 0.4")
            text += '[[drive]]\nbody = "box.floor"\ncomponent = "z"\namplitude = 0.3\nfrequency = 20.0\n'
            text += '[[sample]]\nshape = "sphere"\nbox = [0.0, 0.0, 0.01, 0.3, 0.3, 0.3]\ncount = 40\nradius = [0.02, 0.03]\n'
        else:
            text = wall("floor", [-0.1, -0.05], [0.6, -0.05]) + wall("left", [-0.05, -0.1], [-0.05, 0.7])
            text += wall("right", [0.45, -0.1], [0.45, 0.7]) + wall("lid", [-0.1, 0.65], [0.6, 0.65])
            text += '[[drive]]\nbody = "floor"\ncomponent = "y"\namplitude = 0.3\nfrequency = 20.0\n'
            text += '[[sample]]\nkind = "random"\nbox = [0.0, 0.01, 0.4, 0.5]\ncount = 40\nradius = [0.02, 0.03]\n'
        return start(3 if is_in_space else 2, steps, 7).replace("1e-12", "1e-6") + text

    def table(self, output):
        """Rows of the record without what clocks count."""
        return [{name: value for name, value in row.items() if not name.startswith(("cpu", "wall_"))} for row in self.record(output)]

    def test_restart(self):
        """A run that goes on from a checkpoint between two rows writes the very same files."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        for is_in_space in (False, True):
            with self.subTest(is_in_space=is_in_space):
                words = ("--set", "restart.every=80", "--set", "restart.at_end=false")
                self.run_deck(self.shaken(is_in_space), "--force", *words)
                straight, table = (self.place / "out" / "walls.csv").read_bytes(), self.table("out")
                self.run_deck(self.shaken(is_in_space), *words, "--restart", "out/restart_a.h5")
                self.assertEqual((self.place / "out" / "walls.csv").read_bytes(), straight)
                self.assertEqual(self.table("out"), table)

    def datbox(self, text):
        """Write the scene of a deck as a DATBOX; returns the deck that runs it."""
        (self.place / "native.toml").write_text(text)
        self.run_program("convert", "native.toml", "DATBOX")
        head = text[text.index("[time]"):text.index("[[material]]")]
        dimension = 3 if "dimension = 3" in text else 2
        return f'[scene]\ndimension = {dimension}\ndatbox = "DATBOX"\n' + head

    def test_datbox(self):
        """Walls of a DATBOX: the rows and the cell of the native deck; neither a free bar nor a driven disk is a wall."""
        others = ('[[body]]\nshape = "segment"\nhalf_length = 0.05\nhalf_thickness = 0.01\nposition = [0.2, 0.5]\n'
                  + disk(0.1, 0.6) + 'fixed = true\n')
        for is_in_space in (False, True):
            with self.subTest(is_in_space=is_in_space):
                text = self.shaken(is_in_space, 60) + ("" if is_in_space else others)
                self.run_deck(text, "--force")
                native, record = self.rows(), self.record()
                shutil.rmtree(self.place / "DATBOX", ignore_errors=True)
                deck = self.datbox(text)
                self.run_deck(deck, "--force")
                rows = self.rows()
                self.assertEqual(len(rows), len(native))
                self.assertEqual(len({row["wall"] for row in rows}), 6 if is_in_space else 4)
                # A DATBOX has eight digits, and the solver stops at 1e-6 of the impulses: before collisions drive the two runs
                # apart, forces agree to a thousandth of the largest one.
                largest = max(abs(row["force_z" if is_in_space else "force_y"]) for row in native)
                self.assertGreater(largest, 0)
                for one, other in zip(native, rows, strict=True):
                    for name in set(one) - {"wall"}:
                        scale = largest if "force" in name else 10 * largest if "pressure" in name else 1e-3
                        self.assertLessEqual(abs(one[name] - other[name]), 1e-3 * scale, name)
                names = [name for name in record[0] if name.startswith(("cell", "strain", "void"))]
                self.assertIn("void_ratio", names)
                for one, other in zip(record, self.record(), strict=True):
                    for name in names:
                        self.near(one[name], other[name], 1e2)
                straight = (self.place / "out" / "walls.csv").read_bytes()
                if self.has_hdf5():
                    words = ("--set", "restart.every=25", "--set", "restart.at_end=false")
                    self.run_deck(deck, "--force", *words)
                    self.assertEqual((self.place / "out" / "walls.csv").read_bytes(), straight)
                    self.run_deck(deck, *words, "--restart", "out/restart_a.h5")
                    self.assertEqual((self.place / "out" / "walls.csv").read_bytes(), straight)
                if self.launcher:
                    found = []
                    for ranks in (1, 3):
                        self.on_ranks(ranks, deck, f"parts{ranks}", "--set", "partition.parts=3")
                        found.append((self.place / f"parts{ranks}" / "walls.csv").read_bytes())
                    self.assertEqual(*found)

    def test_ranks(self):
        """The same subdomains on one rank and on three: the same bytes; other subdomains of a scene at rest: the same numbers."""
        if not self.launcher:
            self.skipTest("no MPI")
        self.run_deck(self.plate())
        alone, record = self.rows(), self.table("out")
        self.on_ranks(3, self.plate(), "ranks")
        for a, b in zip(alone, self.rows(output="ranks"), strict=True):
            for name in set(a) - {"wall"}:
                self.near(a[name], b[name], 1e4)
        for a, b in zip(record, self.table("ranks"), strict=True):
            for name in a:
                if name.startswith(("fabric", "cell", "strain", "void", "grain_c", "wall_c")):
                    self.near(a[name], b[name], 1)
        for is_in_space in (False, True):
            found = []
            for ranks in (1, 3):
                self.on_ranks(ranks, self.shaken(is_in_space), f"parts{ranks}", "--set", "partition.parts=3")
                found.append([(self.place / f"parts{ranks}" / "walls.csv").read_bytes(), self.table(f"parts{ranks}")])
            self.assertEqual(*found)


if __name__ == "__main__":
    take_program()
    unittest.main()
