#!/usr/bin/env python3
"""Drives and pressures in time from outside: expressions against the formula, tables and closed forms; sums; files of several columns;
beginnings and ends, in which components are free or stand still; restarts and several ranks; mistakes."""

import csv
import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

G = 9.81
START = """[time]
step = 1e-3
steps = 200
[solver]
criterion = "e8"
tolerance = 1e-12
[output]
record_every = 1
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.3
[[track]]
body = "*"
"""
NO_WEIGHT = "[scene]\ngravity = [0.0, 0.0]\n"
SPACE = "[scene]\ndimension = 3\n"
BALL = """[[body]]
name = "ball"
shape = "disk"
radius = 0.1
position = [0.0, 5.0]
"""
SOLID = BALL.replace("disk", "sphere").replace("[0.0, 5.0]", "[0.0, 0.0, 5.0]")
FLOOR = """[[wall]]
name = "floor"
from = [-1.0, -0.05]
to = [1.0, -0.05]
thickness = 0.1
"""
# For packs, whose steps need not be solved to rounding.
LOOSE = ("--set", "solver.tolerance=1e-4")
MASS = 2500 * math.pi * 0.1**2
# The amplitude of 4 mm at 35 Hz of a tamping machine, as a velocity, going down by 0.1 m/s.
SHAKE = "4e-3*2*pi*35*cos(2*pi*35*t) - 0.1"


def shake(t):
    return 4e-3 * 2 * math.pi * 35 * math.cos(2 * math.pi * 35 * t) - 0.1


def drive(value, body="ball", component="y", more=""):
    return f'[[drive]]\nbody = "{body}"\ncomponent = "{component}"\nvalue = {value}\n{more}'


class Drives(ProgramCase):
    def rows(self, body="ball", output="out"):
        with (self.place / output / "tracks.csv").open(newline="") as file:
            rows = [{name: value if name == "body" else float(value) for name, value in row.items()} for row in csv.DictReader(file)]
        return [row for row in rows if row["body"] == body]

    def run_json(self, output="out"):
        return json.loads((self.place / output / "run.json").read_text())

    def near(self, got, wanted, tolerance=1e-12):
        self.assertLessEqual(abs(got - wanted), tolerance, f"{got} is not {wanted}")

    def test_expression(self):
        """A velocity by an expression, at every step: its closed form; its place: the trapezoidal sum, an amplitude of 4 mm."""
        for text, name in ((START + BALL + drive(f'"{SHAKE}"'), "y"), (SPACE + START + SOLID + drive(f'"{SHAKE}"', component="z"), "z")):
            self.run_deck(text)
            place = 5 + 0.5e-3 * shake(1e-3)
            for row in self.rows():
                self.near(row["velocity_" + name], shake(row["time"]))
                if row["step"] > 1:
                    place += 0.5e-3 * (shake(row["time"]) + shake(row["time"] - 1e-3))
                self.near(row[name], place, 1e-11)
            # The sine is met to the error of the trapezoidal rule: amplitude (omega h)^2/12, and h v/2 of the first step from rest.
            start = 0.5e-3 * shake(0)
            for row in self.rows():
                sine = 5 + 4e-3 * math.sin(2 * math.pi * 35 * row["time"]) - 0.1 * row["time"]
                self.near(row[name] + start, sine, 4e-3 * (2 * math.pi * 35e-3) ** 2 / 12 * 1.01)

    def test_forms(self):
        """Formula, expression, table, sums of them and a table's later column: the same motion, to rounding or to the interpolation."""
        shape = "amplitude = 0.3\nfrequency = 20.0\n"
        wave = "0.3*cos(2*pi*20*t)"
        lines = [f"{i * 1e-3!r} {0.1!r} {0.3 * math.cos(2 * math.pi * 20 * i * 1e-3)!r}" for i in range(201)]
        (self.place / "two.txt").write_text("\n".join(" ".join(line.split()[::2]) for line in lines))
        (self.place / "three.txt").write_text("# time, offset, wave\n" + "\n".join(lines))
        self.run_deck(START + FLOOR + BALL + drive("0.1", "floor", more=shape))
        formula = self.rows("floor")
        for value in (drive(f'"0.1 + {wave}"', "floor"), drive('"0.1"', "floor", more=shape), drive('"if(t < 0, 5, 0.1)"', "floor", more=shape),
                      drive("0.1", "floor", more='file = "two.txt"\n'), drive("0.0", "floor", more=shape + 'file = "three.txt"\ncolumn = 2\n'),
                      drive('"0.05 + 0.05"', "floor", more='file = "three.txt"\ncolumn = 3\n')):
            with self.subTest(value=value):
                self.run_deck(START + FLOOR + BALL + value)
                for a, b in zip(formula, self.rows("floor"), strict=True):
                    self.near(a["velocity_y"], b["velocity_y"])
                    self.near(a["y"], b["y"])

    def test_shaken_floor(self):
        """A ball on a floor that an expression shakes, and on one that a table of few points shakes: as near as the table is."""
        scene = START + FLOOR + BALL.replace("5.0", "0.1")
        self.run_deck(scene + drive('"0.05*sin(2*pi*5*t)"', "floor"))
        fine = self.rows()
        (self.place / "table.txt").write_text("\n".join(f"{i * 5e-3} {0.05 * math.sin(2 * math.pi * 5 * i * 5e-3)}" for i in range(41)))
        self.run_deck(scene + drive("0.0", "floor", more='file = "table.txt"\n'))
        for a, b in zip(fine, self.rows(), strict=True):
            # Linear interpolation over d misses a sine by (omega d)^2/8 of its amplitude, times the time in the place.
            self.near(a["velocity_y"], b["velocity_y"], 0.05 * (2 * math.pi * 5 * 5e-3) ** 2 / 8 * 1.01)
            self.near(a["y"], b["y"], 0.2 * 0.05 * (2 * math.pi * 5 * 5e-3) ** 2 / 8)

    def test_force(self):
        """A force of an expression with a beginning and an end: the momentum is its sum over these steps alone."""
        self.run_deck(NO_WEIGHT + START + BALL + drive('"100*t"', more='kind = "force"\nstart = 0.05\nend = 0.15\n'))
        for row in self.rows():
            t = min(max(row["time"], 0.05), 0.15)
            self.near(row["velocity_y"], 50 * (t**2 - 0.05**2) / MASS)
            self.assertEqual(row["drive_work"], 0)

    def test_pressure(self):
        """A pressure by an expression, on a wall and by a block [[pressure]]; without mass on the other side a fall with more than g."""
        wall = '[[wall]]\nname = "lid"\nfrom = [-1.0, 3.0]\nto = [1.0, 3.0]\nthickness = 0.1\n'
        mass = 2500 * (2 * 0.1 + math.pi * 0.05**2)
        pressed = '[[pressure]]\nbody = "lid"\ndirection = [0, -1]\nlength = 2.0\nvalue = "1000*t"\nstart = 0.1\n'
        for text, start in ((wall + 'pressure = "1000*t"\ndirection = [0, -1]\n', 0), (wall + pressed, 0.1)):
            self.run_deck(NO_WEIGHT + START + BALL + text)
            for row in self.rows("lid"):
                t = max(row["time"], start)
                self.near(row["velocity_y"], -1000 * (t**2 - start**2) / mass, 1e-10)

    def test_release(self):
        """A ball is held, falls from the end of its drive on, and is caught by another one; what is fixed stands still between."""
        hold = drive("0.0", more="end = 0.05\n") + drive("-0.2", more="start = 0.15\n")
        for text, name in ((START + BALL + hold, "y"), (SPACE + START + SOLID + hold.replace('"y"', '"z"'), "z")):
            self.run_deck(text)
            for row in self.rows():
                t = row["time"]
                if t < 0.0501:
                    self.assertEqual([row["velocity_" + name], row[name]], [0, 5])
                elif t < 0.1501:
                    self.near(row["velocity_" + name], -G * (t - 0.05))
                    self.near(row[name], 5 - G * (t - 0.05) ** 2 / 2)
                else:
                    self.near(row["velocity_" + name], -0.2)
            # The drive has caught the ball: it took its kinetic energy, but that of 0.2 m/s, and holds its weight since.
            run = self.run_json()
            self.assertLess(run["energy_closure"], 1e-11)
        self.run_deck(START + FLOOR + BALL + drive("0.5", "floor", more="start = 0.05\nend = 0.1\n"))
        for row in self.rows("floor"):
            self.near(row["velocity_y"], 0.5 if 0.0501 < row["time"] < 0.1001 else 0)

    def test_settle_then_pull(self):
        """A block settles on a floor, is pulled over it, and stops by itself when it is let go: by friction, after v / (mu g)."""
        block = '[[body]]\nname = "block"\nshape = "polygon"\nvertices = [[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]\n' \
                "position = [0.0, 0.05]\n"
        self.run_deck(START + FLOOR + block + drive("0.2", "block", "x", "start = 0.05\nend = 0.1\n"))
        weight = 0.2 * 0.1 * 2500 * G
        for row in self.rows("block"):
            if row["time"] < 0.0501:
                self.near(row["velocity_x"], 0, 1e-9)
            elif row["time"] < 0.1001:
                self.near(row["velocity_x"], 0.2)
                if row["time"] > 0.0515:
                    self.near(row["force_x"], -0.3 * weight, 1e-7 * weight)
            else:
                self.near(row["velocity_x"], max(0, 0.2 - 0.3 * G * (row["time"] - 0.1)), 1e-9)
        self.assertLess(self.run_json()["energy_closure"], 1e-9)

    def shaken_box(self, is_in_space):
        """Grains in a box of which a side is pushed in and let go, and a plate that is held, falls and shakes."""
        if is_in_space:
            side = '[[drive]]\nbody = "box.left"\ncomponent = "x"\nvalue = 0.2\nstart = 0.03\nend = 0.11\n'
            plate = '[[body]]\nname = "plate"\nshape = "box"\nhalf_axes = [0.05, 0.05, 0.01]\nposition = [0.15, 0.15, 0.45]\n'
            held = "".join(drive("0.0", "plate", axis, "end = 0.061\n") for axis in ("x", "y", "z", "rotation_x", "rotation_z"))
            return SPACE + START + "[[container]]\nsize = [0.3, 0.3, 0.5]\n" + side + plate + held + drive(
                '"0.3*cos(200*t)"', "plate", "z", "start = 0.15\n") + \
                '[[sample]]\nshape = "sphere"\nbox = [0.03, 0.0, 0.01, 0.3, 0.3, 0.4]\ncount = 60\nradius = [0.02, 0.03]\n'
        sides = "".join(f'[[wall]]\nname = "{name}"\nfrom = [{x}, -0.1]\nto = [{x}, 1.0]\nthickness = 0.02\n'
                        for name, x in (("left", -0.01), ("right", 0.41)))
        plate = '[[body]]\nname = "plate"\nshape = "polygon"\nvertices = [[-0.1, 0.0], [0.1, 0.0], [0.1, 0.02], [-0.1, 0.02]]\n' \
                "position = [0.2, 0.65]\n"
        held = "".join(drive("0.0", "plate", component, "end = 0.061\n") for component in ("x", "y", "rotation"))
        return START + FLOOR + sides + plate + held + drive('"0.3*cos(200*t)"', "plate", "y", "start = 0.15\n") + drive(
            "0.2", "left", "x", "start = 0.03\nend = 0.11\n") + \
            '[[sample]]\nkind = "random"\nbox = [0.03, 0.0, 0.4, 0.6]\ncount = 60\nradius = [0.02, 0.03]\n'

    def test_energy_and_ranks(self):
        """The energy balance closes through beginnings and ends, on one rank and on three subdomains, in the plane and in space; ranks
        give the bytes of as many subdomains."""
        for is_in_space in (False, True):
            texts = []
            for parts in (1, 3):
                self.run_deck(self.shaken_box(is_in_space), "--set", f"partition.parts={parts}", "--set", "solver.tolerance=1e-4")
                # A plate with three moments of inertia: gyroscopic torques in steps with impacts (doc/theory/indicators.md).
                self.assertLess(self.run_json()["energy_closure"], 1e-3 if is_in_space else 1e-11)
            texts.append((self.place / "out" / "tracks.csv").read_bytes())
            if self.launcher:
                self.call("--quiet", "--set", "partition.parts=3", "--set", "solver.tolerance=1e-4", output="ranks", ranks=3)
                texts.append((self.place / "ranks" / "tracks.csv").read_bytes())
            self.assertEqual(len(set(texts)), 1)

    def test_restart(self):
        """A run in parts, cut while components are free, ends with the same rows."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        for is_in_space in (False, True):
            text = self.shaken_box(is_in_space)
            self.run_deck(text, *LOOSE, "--set", "restart.every=80", "--set", "restart.at_end=false")
            straight = (self.place / "out" / "tracks.csv").read_bytes()
            self.run_program("run", "deck.toml", *LOOSE, "--quiet", "--output", "out", "--restart", "out/restart_a.h5")
            self.assertEqual((self.place / "out" / "tracks.csv").read_bytes(), straight)

    def test_patterns(self):
        """A pattern of names drives, pushes and presses all bodies that match it, as a block for each does; others are free."""
        balls = "".join(BALL.replace("ball", name).replace("[0.0", f"[{float(i)}")
                        for i, name in enumerate(("tine.1", "tine.2", "spade", "tine.10")))  # fmt: skip
        blocks = (drive('"sin(9*t)"', "NAME") + drive('"3*t"', "NAME", "x", 'kind = "force"\n')
                  + '[[pressure]]\nbody = "NAME"\ndirection = [1.0, 0.0]\nlength = 0.2\nvalue = 50.0\n')  # fmt: skip
        self.run_deck(START + balls + blocks.replace("NAME", "tine.*"))
        pattern = (self.place / "out" / "tracks.csv").read_bytes()
        self.run_deck(START + balls + "".join(blocks.replace("NAME", f"tine.{i}") for i in (1, 2, 10)))
        self.assertEqual((self.place / "out" / "tracks.csv").read_bytes(), pattern)
        for row in self.rows("tine.10"):
            self.near(row["velocity_y"], math.sin(9 * row["time"]))
        self.near(self.rows("spade")[-1]["velocity_y"], -G * 0.2)
        self.run_deck(START + balls + blocks.replace("NAME", "tine.?"))
        self.near(self.rows("tine.10")[-1]["velocity_y"], -G * 0.2)
        self.near(self.rows("tine.2")[-1]["velocity_y"], math.sin(9 * 0.2))

    def test_stage_takes_the_place_of_drives_by_a_pattern(self):
        """What a stage drives by a pattern, the drives of the deck do not; the others go on."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no stages")
        balls = "".join(BALL.replace("ball", name).replace("[0.0", f"[{float(i)}") for i, name in enumerate(("a.1", "a.2", "b.1")))
        text = START.replace("steps = 200\n", "") + balls + drive(1.0, "a.1") + drive(2.0, "a.2") + drive(3.0, "b.1")
        text += '[[stage]]\nsteps = 50\n[[stage]]\nsteps = 50\n' + drive(-1.0, "a.*").replace("drive", "stage.drive")
        self.run_deck(text)
        for name, first, last in (("a.1", 1.0, -1.0), ("a.2", 2.0, -1.0), ("b.1", 3.0, 3.0)):
            speeds = [row["velocity_y"] for row in self.rows(name)]
            self.near(speeds[48], first)
            self.near(speeds[98], last)

    def test_mistakes(self):
        """Wrong expressions, times and columns: sentence, line, column, caret."""
        (self.place / "two.txt").write_text("0 1\n1 2\n")
        (self.place / "three.txt").write_text("0 1 2\n1 2 3\n")
        for text, place, sentence in (
                (drive('"4*cs(t)"'), "24:12", 'there is no "cs(t)" here'), (drive('"sin(t"'), "24:14", "a closing bracket should stand here"),
                (drive('"1/t"'), "24:10", "this expression has no value at t = 0.0 s"),
                (drive('"10^60"'), "24:10", "this expression is larger than"), (drive("true"), "24:9", "must be a number or an expression"),
                (drive("1.0", more="start = 0.2\nend = 0.1\n"), "26:7", "the end is not after the start"),
                (drive("1.0", more="end = 0.1\n") + drive("2.0", more="start = 0.05\n"), "28:13", "driven twice at a time"),
                (drive("1.0", "bat*"), "22:8", 'no body has a name that matches "bat*"; the nearest one is "ball"'),
                (drive("1.0") + drive("2.0", "b*"), "27:13", "driven twice at a time"),
                (drive("0.0", more='file = "two.txt"\ncolumn = 3\n'), "two.txt:1:1", "3 numbers or more should stand here"),
                (drive("0.0", more='file = "three.txt"\n'), "three.txt:1:1", 'unless "column" names one'),
                (drive("0.0", more="column = 3\n"), "25:10", 'has no meaning without the key "file"')):
            with self.subTest(text=text):
                said = self.run_deck(START + BALL + text, code=2).stderr
                self.assertIn(f"{place}: error: ", said)
                self.assertIn(sentence, said)
                self.assertIn("^", said)
        (self.place / "deck.toml").write_text(START + BALL + drive('"sin(t)"'))
        said = self.run_program("convert", "deck.toml", "box", code=2).stderr
        self.assertIn("DATBOX files hold no expression", said)

    def test_beside_a_datbox(self):
        """An expression, a beginning and an end drive a body of a DATBOX, which is free at other times."""
        self.run_deck(START.replace('"*"', "1") + BALL)
        self.run_program("convert", "deck.toml", "box")
        text = START.split("[[material]]")[0] + '[scene]\ndatbox = "box"\n[[track]]\nbody = 1\n[[drive]]\nbody = 1\ncomponent = "y"\n' \
            'value = "sin(9*t)"\nstart = 0.1\nend = 0.15\n'
        self.run_deck(text)
        for row in self.rows("1"):
            wanted = -G * row["time"]
            if row["time"] > 0.1001:
                wanted = math.sin(9 * min(row["time"], 0.15)) - G * max(0, row["time"] - 0.15)
            self.near(row["velocity_y"], wanted, 1e-7)


if __name__ == "__main__":
    take_program()
    unittest.main()
