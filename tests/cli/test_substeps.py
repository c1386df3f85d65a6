#!/usr/bin/env python3
"""Steps that are cut into substeps, from outside: a restart changes nothing, subdomains do what one does, dumps hold the last
substep, pushes and traces go with them, and numbers that are none are refused."""

import csv
import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402
from ranks_case import FLOOR, PRESSED  # noqa: E402

SUBSTEPS = ["--quiet", "--set", "time.substeps=3", "--set", "output.record_every=1"]
SPHERES = """[scene]
dimension = 3
[time]
step = 2e-3
steps = 60
[[material]]
name = "stone"
density = 2600.0
[[law]]
friction = 0.5
[[container]]
size = [0.3, 0.2, 0.3]
[[sample]]
kind = "lattice"
box = [0.0, 0.0, 0.0, 0.3, 0.2, 0.2]
radius = [0.018, 0.02]
"""

COLUMN = """[time]
step = 1e-3
steps = 20
[output]
record_every = 1
[solver]
method = "nlgs"
criterion = "e8"
[[material]]
name = "stone"
density = 1000.0
[[law]]
friction = 0.3
[[body]]
shape = "polygon"
vertices = [[-1.0, -0.1], [1.0, -0.1], [1.0, 0.1], [-1.0, 0.1]]
position = [0.0, -0.1]
fixed = true
"""

FLIGHT = """[scene]
gravity = [0.0, 0.0]
[time]
step = 4.0
steps = 1
[[material]]
name = "stone"
density = 1.0
[[law]]
friction = 0.5
[[body]]
shape = "polygon"
vertices = SQUARE
position = [0.0, 0.0]
spin = SPIN
[[body]]
shape = "polygon"
vertices = SQUARE
position = [-500.0, 1.05]
velocity = [1e3, 0.0]
spin = SPIN
[[interaction]]
alert = 0.1
"""
# Two bodies of 1 kg: both of 0.01 rad/s and 1/6 kg m^2, one of 1e3 m/s
FLIGHT_ENERGY = 1e6 / 2 + 1e-4 / 6


class Substeps(ProgramCase):
    def run_deck(self, text, output, *words, code=0):
        (self.place / "deck.toml").write_text(text)
        return self.run_program("run", "deck.toml", "--output", output, *words, code=code)

    def run_json(self, folder):
        return json.loads((self.place / folder / "run.json").read_text())

    def test_restart(self):
        """A run that is interrupted goes on to the same numbers, digit by digit, with pushes too."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        for extra in ([], ["--set", "time.recovery=1e-4"]):
            for text, half, steps in ((PRESSED, 67, 120), (SPHERES, 31, 60)):
                with self.subTest(extra=extra, steps=steps):
                    words = [*SUBSTEPS, *extra]
                    self.run_deck(text, "straight", *words, "--force", "--set", f"time.steps={steps}")
                    self.run_deck(text, "parts", *words, "--force", "--set", f"time.steps={half}")
                    self.run_deck(text, "parts", *words, "--set", f"time.steps={steps}", "--restart", "parts")
                    self.assertEqual(len(self.rows("straight")), steps)
                    self.assertEqual(self.rows("straight"), self.rows("parts"))

    def test_restart_other_length(self):
        """A column at rest goes on at rest by steps of another length, though a solve of one sweep cannot find its weights again."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        column = COLUMN + "".join(f'[[body]]\nshape = "disk"\nradius = 0.1\nposition = [0.0, {0.1 + 0.2 * i:.1f}]\n' for i in range(10))
        self.run_deck(column, "rest", "--quiet", "--set", "solver.tolerance=1e-14", "--set", "solver.maximum_sweeps=10000")
        few = ["--set", "solver.maximum_sweeps=1", "--set", "solver.check_every=1", "--set", "time.steps=30"]
        for other in (["time.substeps=5"], ["time.step=2e-4"], ["time.step=4e-3"]):
            with self.subTest(other=other):
                words = [word for key in other for word in ("--set", key)]
                self.run_deck(column, "out", "--quiet", "--force", "--restart", "rest", *few, *words)
                # Weights are right to 1e-12 of 10 steps of gravity; a guess of another length moves the top at 0.1 m/s and more.
                self.assertLess(max(float(row["kinetic_energy"]) for row in self.rows("out")), 1e-18)

    def test_flight(self):
        """A body that flies off stays free, whatever way both turn: 0.01 rad and 1000 sizes per substep."""
        for spin in (0.01, -0.01):
            with self.subTest(spin=spin):
                # Square to the way of flight where contacts are found: in the middle of the first substep.
                corners = [math.pi / 4 * (1 + 2 * i) - spin / 2 for i in range(4)]
                square = [[math.cos(angle) / math.sqrt(2), math.sin(angle) / math.sqrt(2)] for angle in corners]
                text = FLIGHT.replace("SPIN", str(spin)).replace("SQUARE", str(square))
                self.run_deck(text, "out", "--quiet", "--force", "--set", "time.substeps=4", "--set", "output.record_every=1")
                self.assertEqual(max(int(row["contacts"]) for row in self.rows("out")), 2)
                # Neither impulse nor friction: the energy is that of the start, to rounding.
                energies = [float(row["kinetic_energy"]) for row in self.rows("out")]
                self.assertAlmostEqual(energies[-1] / FLIGHT_ENERGY, 1.0, delta=1e-12)

    def test_counts(self):
        """Steps are those of the deck, sweeps those of all substeps, and the balance of energy closes."""
        one = [*SUBSTEPS, "--set", "solver.maximum_sweeps=7", "--set", "solver.check_every=7", "--set", "solver.tolerance=1e-14"]
        self.run_deck(PRESSED, "out", *one, "--set", "time.steps=50")
        run = self.run_json("out")
        self.assertEqual(run["steps"], 50)
        self.assertEqual(max(int(row["sweeps"]) for row in self.rows("out")), 3 * 7)
        self.assertLess(run["energy_closure"], 1e-10)
        self.assertIn("steps of 1.000E-03 s in 3 substeps each", self.run_deck(PRESSED, "out", "--force", *SUBSTEPS[1:]).stdout)

    def test_subdomains(self):
        """Tight solves on several subdomains, by all couplings, end where one does: to the tolerance of the solves times the steps."""
        tight = [*SUBSTEPS, "--force", "--set", "time.steps=30", "--set", 'solver.criterion="e8"', "--set", "solver.tolerance=1e-10",
                 "--set", "solver.maximum_sweeps=100000"]
        self.run_deck(SPHERES, "out", *tight)
        energy = self.run_json("out")["potential_energy"]
        for gluing in ("dual", "primal", "momentum"):
            method = "nlgs" if gluing == "momentum" else "nesterov"
            words = ["--set", "partition.parts=3", "--set", f'partition.gluing="{gluing}"', "--set", f'solver.method="{method}"']
            with self.subTest(gluing=gluing):
                self.run_deck(SPHERES, "out", *tight, *words)
                run = self.run_json("out")
                self.assertEqual(run["unconverged_steps"], 0)
                self.assertAlmostEqual(run["potential_energy"] / energy, 1, delta=1e-8)

    def test_dump(self):
        """The dump of a step holds the problem of its last substep, whose solution the record shows."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no dumps")
        self.run_deck(PRESSED, "out", *SUBSTEPS, "--set", "time.steps=40", "--dump", "40")
        answer = json.loads(self.run_program("solve", "out/dump-40-local.hdf5", "--json").stdout)
        self.assertTrue(answer["converged"])
        self.assertEqual(answer["contacts"], self.run_json("out")["contacts"])

    def test_failed_solve(self):
        """A run that ends by a solve that does not converge leaves that substep's problem as a dump, and a checkpoint."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no dumps")
        few = ["--set", "solver.maximum_sweeps=1", "--set", "solver.check_every=1", "--set", "solver.stop_unconverged=true"]
        self.run_deck(PRESSED, "out", *SUBSTEPS, *few, code=3)
        step = self.run_json("out")["steps"]
        answer = json.loads(self.run_program("solve", f"out/dump-{step}-local.hdf5", "--json").stdout)
        self.assertTrue(answer["converged"])

    def test_trace(self):
        """A traced run has the history of one substep of each traced step."""
        self.run_deck(PRESSED, "out", *SUBSTEPS, "--set", "time.steps=40", "--set", "report.trace=true", "--set", "report.trace_steps=[20, 30]")
        with (self.place / "out" / "trace.csv").open() as file:
            steps = [int(row["step"]) for row in csv.DictReader(line for line in file if not line.startswith("#"))]
        self.assertLessEqual({20, 30}, set(steps))
        self.assertLessEqual(set(steps), {20, 30, 40})

    def test_memory(self):
        """What substeps keep is in the list of tables, and nothing of it is there without them."""
        polygons = SPHERES.replace("dimension = 3\n", "").replace("[scene]\n", "").replace(
            "[[container]]\nsize = [0.3, 0.2, 0.3]\n", FLOOR).replace("[0.0, 0.0, 0.0, 0.3, 0.2, 0.2]", "[0.0, 0.0, 0.6, 0.4]")
        polygons += 'shape = "polygon"\n'
        start = {"step_start.position", "step_start.velocity", "step_start.angle"}
        for text, own in ((polygons, start | {"carry.face", "carry.before", "carry.turn", "carry.manner"}),
                          (SPHERES, {"step_start.position", "step_start.velocity", "step_start.orientation", "carry.manner"})):
            for count in (1, 3):
                with self.subTest(own=own, count=count):
                    self.run_deck(text, "out", "--quiet", "--force", "--needs", "--set", f"time.substeps={count}")
                    needs = json.loads((self.place / "out" / "needs.json").read_text())
                    tables = {name for name in needs if name.startswith(("carry.", "step_start."))}
                    self.assertEqual(tables, own if count > 1 else set())

    def test_refused(self):
        """Numbers of substeps that are none."""
        for value in ("0", "-2", "1.5"):
            text = PRESSED.replace("[solver]", f"substeps = {value}\n[solver]", 1)
            said = self.run_deck(text, "out", "--quiet", code=2).stderr
            self.assertRegex(said, r"deck\.toml:4:12: error: .*substeps")
            self.assertIn("^", said)


if __name__ == "__main__":
    take_program()
    unittest.main()
