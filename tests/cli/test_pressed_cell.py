#!/usr/bin/env python3
"""Planes of a container that are pressed on the area that they close now, by pressures or by the stresses of the container: forces,
energy, stages, restarts to the byte, ranks, mistakes."""

import csv
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

PRESSURE = 300.0
THICKNESS = 0.02
DENSITY = 2500.0
STEP = 1e-3
SIZE = (0.3, 0.2, 0.25)
HEAD = f"""[scene]
dimension = 3
gravity = [0.0, 0.0, 0.0]
PERIOD
[time]
step = {STEP}
steps = 150
[solver]
criterion = "e8"
tolerance = 1e-10
[output]
record_every = 1
[[material]]
name = "stone"
density = {DENSITY}
[[law]]
friction = 0.3
[[container]]
size = {list(SIZE)}
thickness = {THICKNESS}
lid = true
"""
PRESSED = f"""[[pressure]]
body = "box.right"
direction = [-1.0, 0.0, 0.0]
value = {PRESSURE}
[[pressure]]
body = "box.lid"
direction = [0.0, 0.0, -2.0]
value = {PRESSURE}
"""
DRIVEN = """[[drive]]
body = "box.back"
component = "y"
value = -0.2
"""
GRAINS = """[[sample]]
box = [0.0, 0.0, 0.0, 0.3, 0.2, 0.25]
kind = "lattice"
radius = 0.02
spacing = 1.2
"""
# Sums of some hundred products in double precision.
ROUNDING = 1e-11


class PressedCell(ProgramCase):
    def run_deck(self, text, *words, output="out", code=0):
        return super().run_deck(text.replace("PERIOD\n", ""), *words, output=output, code=code)

    def rows(self, output="out"):
        with (self.place / output / "walls.csv").open(newline="") as file:
            found = {}
            for row in csv.DictReader(file):
                found.setdefault(row["wall"], []).append({k: float(v) for k, v in row.items() if k != "wall"})
        return found

    def run_json(self, output="out"):
        return json.loads((self.place / output / "run.json").read_text())

    def check_forces(self, rows, depths, beyond=2 * THICKNESS):
        """Planes without contacts are pushed by the pressure times their area at the beginning of the step; `depths` are those
        along y at the ends of the steps, `beyond` what planes are longer there."""
        mass_right = DENSITY * THICKNESS * (SIZE[1] + beyond) * (SIZE[2] + 2 * THICKNESS)
        mass_lid = DENSITY * THICKNESS * (SIZE[0] + 2 * THICKNESS) * (SIZE[1] + beyond)
        for n in range(1, len(rows["box.lid"])):
            length, depth = rows["box.right"][n - 1]["x"] - rows["box.left"][n - 1]["x"] - THICKNESS, depths[n - 1]
            height = rows["box.lid"][n - 1]["z"] - rows["box.floor"][n - 1]["z"] - THICKNESS
            for plane, component, mass, area in (("box.right", "velocity_x", mass_right, depth * height),
                                                 ("box.lid", "velocity_z", mass_lid, depth * length)):  # fmt: skip
                force = mass * (rows[plane][n][component] - rows[plane][n - 1][component]) / STEP
                self.assertAlmostEqual(force / (-PRESSURE * area), 1.0, delta=ROUNDING * 1e3)

    def test_forces(self):
        """Two directions pressed and a third driven: force = pressure times the present area; all work is accounted for."""
        self.run_deck(HEAD + PRESSED + DRIVEN)
        rows = self.rows()
        depths = [back["y"] - front["y"] - THICKNESS for back, front in zip(rows["box.back"], rows["box.front"])]
        self.assertLess(depths[-1], 0.9 * SIZE[1])
        self.assertLess(rows["box.lid"][-1]["z"], 0.95 * rows["box.lid"][0]["z"])
        self.check_forces(rows, depths)
        self.assertLess(self.run_json()["energy_closure"], ROUNDING)

    def test_period(self):
        """Along a period the length is that of the period."""
        text = HEAD.replace("PERIOD", f"period_y = {SIZE[1]}") + PRESSED
        self.run_deck(text)
        rows = self.rows()
        self.assertNotIn("box.back", rows)
        self.check_forces(rows, [SIZE[1]] * len(rows["box.lid"]), beyond=0.0)

    def test_given_area(self):
        """An area that the deck gives stays as it is."""
        self.run_deck(HEAD + PRESSED.replace("value", "area = 0.05\nvalue"))
        velocity = [row["velocity_x"] for row in self.rows()["box.right"]]
        for n in range(1, len(velocity) - 1):
            self.assertAlmostEqual(velocity[n + 1] - velocity[n], velocity[n] - velocity[n - 1], delta=1e-13)

    def test_grains(self):
        """With grains: the balance of energy closes, a restart goes on to the byte, ranks find the same."""
        text = HEAD + PRESSED + DRIVEN + GRAINS
        words = ("--set", "restart.every=80", "--set", "restart.at_end=false") if self.has_hdf5() else ()
        self.run_deck(text, *words)
        run = self.run_json()
        self.assertGreater(run["contacts"], 20)
        self.assertLess(run["energy_closure"], 1e-9)
        straight = (self.place / "out" / "walls.csv").read_bytes()
        if self.has_hdf5():
            self.run_deck(text, *words, "--restart", "out/restart_a.h5")
            self.assertEqual((self.place / "out" / "walls.csv").read_bytes(), straight)
        if not self.launcher:
            return
        rows = self.rows()
        for ranks in (2, 3):
            self.on_ranks(ranks, text.replace("PERIOD\n", ""), "ranks")
            for name, plane in self.rows("ranks").items():
                # Impulses of a pack are not unique, and the solver is content with 1e-10: planes move alike to some 1e-6 m.
                for component in "xyz":
                    self.assertAlmostEqual(plane[-1][component], rows[name][-1][component], delta=2e-6)

    def stressed(self, stresses):
        """The head with keys of the container."""
        return HEAD + "".join(f"stress_{axis}{axis} = {value}\n" for axis, value in stresses.items())

    def test_stresses(self):
        """Stresses of a container are pressures on its upper planes: the same files to the byte, whatever the numbers are."""
        self.run_deck(HEAD + PRESSED + DRIVEN + GRAINS)
        pressed = (self.place / "out" / "walls.csv").read_bytes()
        self.run_deck(self.stressed({"x": PRESSURE, "z": PRESSURE}) + DRIVEN + GRAINS)
        self.assertEqual((self.place / "out" / "walls.csv").read_bytes(), pressed)
        # A drive, or a pressure, takes the place of a stress.
        self.run_deck(self.stressed({"x": 17.0, "y": 1e3, "z": f'"{PRESSURE}*cos(0*t)"'}) + DRIVEN + GRAINS + PRESSED.split("[[pressure]]\nbody = \"box.lid")[0])
        self.assertEqual((self.place / "out" / "walls.csv").read_bytes(), pressed)

    def test_stress_tensor(self):
        """A compacted pack under three stresses reads them, on all six planes and in the mean stress; the next stage turns to others.

        A cubic pack without friction comes to rest to rounding, and so do the forces on planes. The mean stress is over the box of
        the grains, which enter the planes by what the solver leaves: some 1e-5 of it."""
        if not self.has_hdf5():
            self.skipTest("stages need HDF5")
        text = self.stressed({"x": 2e3, "y": 3e3, "z": 4e3}).replace("steps = 150\n", "").replace("friction = 0.3", "friction = 0.0")
        text = text.replace("record_every = 1\n", "record_every = 100\nrecord_mean = true\n").replace("1e-10", "1e-3")
        text = text.replace(str(list(SIZE)), "[0.12, 0.12, 0.12]") + GRAINS.replace("0.3, 0.2, 0.25", "0.12, 0.12, 0.12").replace("1.2", "1.02")
        stages = ('[[stage]]\nname = "first"\nsteps = 800\n'
                  '[[stage]]\nname = "second"\nsteps = 800\n[[stage.container]]\nstress_xx = 4e3\nstress_yy = 4e3\n')
        self.run_deck(text + stages)
        last = {"1": None, "2": None}
        with (self.place / "out" / "record.csv").open(newline="") as file:
            for row in csv.DictReader(file):
                last[row["stage"]] = row
        for stage, wanted in (("1", (2e3, 3e3, 4e3)), ("2", (4e3, 4e3, 4e3))):
            for axis, value in zip("xyz", wanted, strict=True):
                self.assertAlmostEqual(float(last[stage][f"mean_stress_{axis}{axis}"]) / value, 1.0, delta=1e-4, msg=f"{stage} {axis}")
        rows = self.rows()
        for stage, at in (("1", 7), ("2", 15)):
            for names, axis in ((("left", "right"), 0), (("front", "back"), 1), (("floor", "lid"), 2)):
                for name in names:
                    wanted = {"1": (2e3, 3e3, 4e3), "2": (4e3, 4e3, 4e3)}[stage][axis]
                    self.assertAlmostEqual(rows[f"box.{name}"][at]["mean_pressure"] / wanted, 1.0, delta=1e-9, msg=f"{stage} {name}")

    def test_compaction(self):
        """A stage that closes the cell ends at the wanted void ratio, to the step; the next one holds the planes there."""
        drives = "".join(f'[[stage.drive]]\nbody = "box.{name}"\ncomponent = "{axis}"\nvalue = -0.1\n'
                         for name, axis in (("right", "x"), ("back", "y"), ("lid", "z")))  # fmt: skip
        stages = ('[[stage]]\nname = "close"\nduration = 0.5\nuntil = "void_ratio < 2.0"\n' + drives + '[[stage]]\nname = "hold"\nsteps = 5\n')
        if not self.has_hdf5():
            self.skipTest("stages need HDF5")
        self.run_deck(HEAD.replace("steps = 150\n", "") + GRAINS + stages)
        with (self.place / "out" / "record.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        closed = [float(row["void_ratio"]) for row in rows if row["stage"] == "1"]
        self.assertGreater(closed[0], 2.5)
        self.assertLess(closed[-1], 2.0)
        self.assertGreaterEqual(closed[-2], 2.0)
        self.assertEqual({row["void_ratio"] for row in rows if row["stage"] == "2"}, {rows[-1]["void_ratio"]})

    def test_mistakes(self):
        """Only a plane of a container has an area of its own, along its normal."""
        askew = self.run_deck(HEAD + PRESSED.replace("[-1.0, 0.0, 0.0]", "[-1.0, 0.1, 0.0]"), code=2)
        self.assertIn("is pressed along its normal, x", askew.stdout + askew.stderr)
        body = '[[body]]\nname = "stone"\nshape = "sphere"\nradius = 0.05\nposition = [0.1, 0.1, 0.1]\n'
        free = self.run_deck(HEAD + body + PRESSED.replace("box.lid", "stone"), code=2)
        self.assertIn('needs the key "area"', free.stdout + free.stderr)
        for text, said in (
            (self.stressed({"z": 1e3}).replace("lid = true", ""), "stress_zz needs a lid: lid = true"),
            (self.stressed({"x": 1e3}) + "sides = false\n", "stress_xx needs planes at both sides: sides = true, and no period along x"),
            (self.stressed({"y": 1e3}).replace("PERIOD", f"period_y = {SIZE[1]}"), "stress_yy needs planes at both sides"),
            (self.stressed({"y": '"1/t"'}), "has no value at t = 0.0 s"),
            (HEAD + '[[stage]]\nsteps = 9\n[[stage.container]]\nname = "bax"\nstress_xx = 1.0\n', 'there is no container named "bax"'),
            (HEAD + '[[stage]]\nsteps = 9\n[[stage.container]]\nlid = false\n', '"lid" cannot change between stages'),
        ):
            done = self.run_deck(text, code=2)
            self.assertIn(said, done.stdout + done.stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
