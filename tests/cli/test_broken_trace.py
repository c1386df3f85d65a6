#!/usr/bin/env python3
"""Test that a traced run which ends by a broken step leaves the history of that step, on one rank and on several.

usage: test_broken_trace.py PROGRAM [MPIEXEC] [unittest options]
"""

import csv
import json
import re
import unittest

from ranks_case import BEYOND, COMMON, FLOOR, Ranks, take_launcher

TRACE = ["--set", "report.trace=true", "--set", "output.record_every=1"]
# A step that is not named beforehand.
ELSEWHERE = ["--set", "report.trace_steps=1000000"]
UNCONVERGED = ["--set", "solver.maximum_sweeps=3", "--set", "solver.tolerance=1e-14", "--set", "solver.stop_unconverged=true"]
# With theta 1 the balance is open by the order of the step.
UNBALANCED = ["--set", "time.theta=1.0", "--set", 'guard.energy="stop"']
# Rows of disks on one another, which touch from the start.
PILE = COMMON + FLOOR + "".join(f"""[[body]]
shape = "disk"
radius = 0.05
position = [{0.05 + 0.1 * i + 0.05 * (j % 2):g}, {0.05 + 0.0866 * j:g}]
""" for i in range(5) for j in range(3))  # fmt: skip
# A disk meets a light one, which leaves it faster than what has a finite energy where there is a wall so heavy. No number overflows.
FAST = """[scene]
gravity = [0.0, 0.0]
[time]
step = 1e-49
steps = 5
[[material]]
name = "stone"
density = 1.0
[[material]]
name = "giant"
density = 1e50
[[law]]
kind = "RST_CLB"
friction = 0.3
normal_restitution = 1.0
[[wall]]
material = "giant"
from = [-1e40, -3e40]
to = [1e40, -3e40]
thickness = 1e40
""" + "".join(f"""[[body]]
shape = "disk"
material = "stone"
radius = 0.5
position = [{x}, 0.0]
mass = {mass}
velocity = [{speed}, 0.0]
""" for x, mass, speed in ((0.0, 1.0, 1e48), (1.0, 1e-3, 0.0), (5.0, 1e-3, 0.0), (6.0, 1e-3, 0.0)))  # fmt: skip


class BrokenTrace(Ranks):
    def traced(self, ranks, deck, *words, code, output):
        """Rows of trace_steps.csv and trace.csv, and what was said, of a run that must end with this exit code."""
        words = ["run", deck, "--force", "--output", output, *TRACE, *words]
        done = self.launch((ranks, *words), code=code) if ranks > 1 else self.run_program(*words, code=code)
        files = [(self.place / output / f"{name}.csv").read_text().splitlines() for name in ("trace_steps", "trace")]
        return *(list(csv.DictReader(lines)) for lines in files), done

    def all_ranks(self):
        return (1, 3) if self.launcher else (1,)

    @staticmethod
    def without_times(rows):
        return [{name: value for name, value in row.items() if not re.search("seconds|^cpu_|^wall_", name)} for row in rows]

    def check_broken(self, name, text, code, words=(), gluings=("dual",)):
        """The step is solved once more, and has the history that it has where it is traced on purpose; nothing else changes.
        Subdomains of one process, whose numbers are those of ranks, trace it on purpose."""
        deck = self.deck(text)
        for ranks in self.all_ranks():
            for gluing in gluings if ranks > 1 else ("none",):
                with self.subTest(name, ranks=ranks, gluing=gluing):
                    more = [*words, "--set", f'partition.gluing="{gluing}"'] if ranks > 1 else list(words)
                    steps, points, done = self.traced(ranks, deck, *more, *ELSEWHERE, code=code,
                                                      output=f"broken on {ranks}")  # fmt: skip
                    self.assertEqual(len(steps), 1)
                    step = steps[0]
                    self.assertRegex(done.stdout, rf"(?m)^ +{step['step']} +{step['contacts']} +{step['sweeps']} ")
                    parts = ["--set", f"partition.parts={ranks}"] if ranks > 1 else []
                    asked = self.traced(1, deck, *more, *parts, "--set", f"report.trace_steps={step['step']}", code=code,
                                        output="asked")  # fmt: skip
                    self.assertEqual(*map(self.without_times, (steps, asked[0])))
                    self.assertEqual(*map(self.without_times, (points, asked[1])))
                    self.assertEqual(*(self.without_times(self.rows(folder)) for folder in (f"broken on {ranks}", "asked")))
                    self.assertGreater(int(step["contacts"]), 0)
                    self.assertGreater(len(points), 1)
                    self.assertEqual({point["step"] for point in points}, {step["step"]})
                    self.assertEqual((points[0]["iteration"], points[-1]["iteration"]), ("0", step["sweeps"]))
                    for error in ("e1", "e2", "e8"):
                        # Solvers of matrices sum in another order.
                        self.assertAlmostEqual(float(points[-1][error]), float(step[error]), delta=1e-6 * float(step[error]))
        return step

    def test_steps_that_do_not_converge(self):
        step = self.check_broken("unconverged", PILE, 3, UNCONVERGED, ("dual", "primal", "contacts"))
        self.assertEqual((step["sweeps"], step["converged"]), ("3", "0"))

    def test_balances_that_are_open(self):
        self.check_broken("unbalanced", PILE, 6, UNBALANCED)

    def test_speeds_beyond_all_energies(self):
        step = self.check_broken("fast", FAST, 4)
        self.assertEqual(step["step"], "1")
        for ranks in self.all_ranks() if self.has_hdf5() else ():
            with self.subTest(ranks=ranks):
                # The impact of one disk on another is left to be solved again.
                dumps = [f"broken on {ranks}/dump-1-{form}.hdf5" for form in ("local", "global")]
                said = self.run_program("solve", *dumps, "--json").stdout
                for line in map(json.loads, said.splitlines()):
                    self.assertEqual(line["contacts"], int(step["contacts"]))
                    self.assertLess(line["e1"], 1e-8)

    def test_matrix_solvers(self):
        self.launcher = None  # They work on one rank.
        self.check_broken("matrices", PILE, 3, [*UNCONVERGED, "--set", 'solver.method="accelerated"'])

    def test_a_problem_that_is_broken_before_it_is_solved(self):
        """There is no history, only a row of zero sweeps and errors not a number."""
        if "ffpe-trap" in self.run_program("--version").stdout:
            self.skipTest("this build stops where numbers overflow")
        deck = self.deck(BEYOND)
        for ranks in self.all_ranks():
            with self.subTest(ranks=ranks):
                steps, points, done = self.traced(ranks, deck, code=4, output="out")
                self.assertEqual(points, [])
                self.assertEqual([(row["step"], row["sweeps"], row["converged"], row["e1"]) for row in steps], [("1", "0", "0", "nan")])
                self.assertRegex(done.stdout, r"(?m)^ +1 +\d+ +0 +NaN")


if __name__ == "__main__":
    take_launcher()
    unittest.main(verbosity=1)
