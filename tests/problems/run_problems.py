#!/usr/bin/env python3
"""Solve real contact problems of other codes by `splitgrain solve`, and test the subcommand from outside.

usage: run_problems.py PROGRAM [unittest options]

The problems are FCLIB files of a folder `problems`, beside the project or below SPLITGRAIN_SHARED; without them, or without
HDF5, only what needs no file is tested; our own problems are made here from decks of input_decks.
"""

import csv
import json
import os
import shutil
import stat
import sys
import unittest
from pathlib import Path

from own_problems import SMALL, SOURCE, dump

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

PROBLEMS = Path(os.environ.get("SPLITGRAIN_SHARED") or SOURCE.parent / "shared") / "problems"

# Contacts of each problem.
CONTACTS = {
    "FC3D_Example1": 3,
    "Rover1039": 4,
    "Rover4613": 5,
    "OneObject-i1028-138": 23,
    "OneObject-i100000-499": 24,
    "NESpheres_30_1": 44,
    "BoxesStack1-i100000-32": 52,
    "Confeti-ex03-Fc3D-SBM": 54,
    "LMGC_100_PR_PerioBox-i00361-60-03000": 60,
    "Box_Stacks-i0122-82-5": 82,
    "spheres-in-a-box-98-i10000-256-10": 256,
    "Capsules-i100-889": 276,
    "Capsules-i125-1213": 286,
    "Spheres-i099-356-679": 356,
    "KaplasTower-i1061-4": 570,
}
IN_GLOBAL_FORM = ["Box_Stacks-i0122-82-5", "Spheres-i099-356-679", "spheres-in-a-box-98-i10000-256-10"]
TOLERANCE = 1e-8
# Names that scripts rely on.
KEYS = {"file", "contacts", "solver", "iterations", "cpu_seconds", "e1", "e2", "e8", "converged"}


class Solve(ProgramCase):
    timeout = 600

    def solve(self, *words, code=0):
        """Run the subcommand in the test's folder; its exit code must be this one."""
        return self.run_program("solve", *words, code=code)

    def solve_json(self, *words, code=0):
        """The objects that the subcommand prints, one a line."""
        return [json.loads(line) for line in self.solve(*words, "--json", code=code).stdout.splitlines()]


class CommandLine(Solve):
    def test_mistakes(self):
        for words, said in (
            ([], "solve FILE..."),
            (["a.hdf5", "--solver", "nlsg"], 'did you mean "nlgs"?'),
            (["a.hdf5", "--tolerance", "-1"], "--tolerance"),
            (["a.hdf5", "--tolerance", "nan"], "--tolerance"),
            (["a.hdf5", "--iterations", "0"], "--iterations"),
            (["a.hdf5", "--seconds", "soon"], "--seconds"),
            (["a.hdf5", "--gess"], "did you mean --guess?"),
        ):
            with self.subTest(words=words):
                self.assertIn(said, self.solve(*words, code=2).stderr)

    def test_no_such_file(self):
        said = self.solve("none.hdf5", code=2)
        self.assertRegex(said.stderr, r"^none.hdf5: error: there is no such file\n$")
        self.assertIn("0 of 1 problems solved", said.stdout)
        self.assertEqual(self.solve_json("none.hdf5", code=2), [
            {"file": "none.hdf5", "error": "there is no such file", "converged": False}])

    def test_no_hdf5_file(self):
        (self.place / "text.hdf5").write_text("u = W r + q")
        said = self.solve("text.hdf5", code=2).stderr
        self.assertRegex(said, "this is no HDF5 file" if self.has_hdf5() else "built without HDF5")
        self.assertEqual(said.count("\n"), 1)


class Own(Solve):
    """The default solver on steps of our own decks, in the plane and in space, in both forms."""

    def test_default_solves_steps_of_our_decks(self):
        if not self.has_hdf5():
            self.skipTest("built without HDF5")
        for name in SMALL:
            with self.subTest(name=name):
                local = dump(self.program, self.place, name)
                rows = self.solve_json(local, local.with_name(local.name.replace("local", "global")), "--tolerance", TOLERANCE)
                self.assertEqual([row["dimension"] for row in rows], [2 if "plane" in name else 3] * 2)
                self.assertEqual(rows[0]["contacts"], rows[1]["contacts"])
                # One sweep does not do: these are no trivial problems.
                first, = self.solve_json(local, "--solver", "nlgs", "--iterations", 1, code=3)
                self.assertGreater(first["e1"], TOLERANCE)
                for row in rows:
                    self.assertGreater(row["contacts"], 20)
                    self.assertIs(row["converged"], True)
                    self.assertLessEqual(row["e1"], TOLERANCE)


class Real(Solve):
    def setUp(self):
        super().setUp()
        if not self.has_hdf5():
            self.skipTest("built without HDF5")
        if not PROBLEMS.is_dir():
            self.skipTest(f"no real problems in {PROBLEMS}")

    def copy(self, name):
        shutil.copy(PROBLEMS / f"{name}.hdf5", self.place)
        (self.place / f"{name}.hdf5").chmod(stat.S_IRUSR | stat.S_IWUSR)
        return f"{name}.hdf5"

    def test_default_solves_all(self):
        rows = self.solve_json(*(PROBLEMS / f"{name}.hdf5" for name in CONTACTS), "--tolerance", TOLERANCE)
        self.assertEqual([row["contacts"] for row in rows], list(CONTACTS.values()))
        for row in rows:
            with self.subTest(file=row["file"]):
                self.assertLessEqual(KEYS, row.keys())
                self.assertIs(row["converged"], True)
                self.assertLessEqual(row["e1"], TOLERANCE)
                # |q| is at most the scale of e2.
                self.assertLessEqual(row["e2"], row["e1"])
                self.assertGreaterEqual(row["cpu_seconds"], 0)

    def test_global_form_is_solved_as_the_local_one(self):
        both = [PROBLEMS / folder / f"{name}.hdf5" for name in IN_GLOBAL_FORM for folder in ("", "global")]
        rows = self.solve_json(*both)
        for local, other in zip(rows[::2], rows[1::2]):
            self.assertEqual(local["contacts"], other["contacts"])
            self.assertLessEqual(max(local["e1"], other["e1"]), TOLERANCE)

    def test_table_and_verdict(self):
        printed = self.solve(PROBLEMS / "Rover1039.hdf5", PROBLEMS / "Rover4613.hdf5").stdout.splitlines()
        self.assertEqual(len(printed), 4)
        self.assertEqual(printed[0].split(), "file contacts solver iterations cpu seconds e1 e2 e8 converged".split())
        # Columns end in one place.
        self.assertEqual(len({line.index("  yes") for line in printed[1:3]} | {printed[0].index("  converged")}), 1)
        self.assertRegex(printed[-1], r"^2 of 2 problems solved to e1 <= 1\.00E-08$")

    def test_not_converged(self):
        row, = self.solve_json(PROBLEMS / "Capsules-i100-889.hdf5", "--solver", "nlgs", "--iterations", 2, code=3)
        self.assertIs(row["converged"], False)
        self.assertGreater(row["e1"], TOLERANCE)
        self.assertLessEqual(row["iterations"], 2)

    def test_bad_files_do_not_stop_the_others(self):
        cut = self.copy("Rover1039")
        content = (self.place / cut).read_bytes()
        (self.place / cut).write_bytes(content[: len(content) // 2])
        bad, good = self.solve_json(cut, PROBLEMS / "Rover4613.hdf5", code=2)
        self.assertIn("truncated", bad["error"])
        self.assertIs(good["converged"], True)

    def test_trace(self):
        files = [PROBLEMS / "OneObject-i1028-138.hdf5", PROBLEMS / "Rover4613.hdf5"]
        rows = self.solve_json(*files, "--solver", "nlgs", "--trace", "trace.csv")
        with open(self.place / "trace.csv", newline="") as file:
            trace = list(csv.DictReader(file))
        self.assertEqual(list(trace[0]), ["solver", "file", "iteration", "contact_updates", "cpu_seconds", "e1", "e2", "e8"])
        for row in rows:
            points = [point for point in trace if point["file"] == row["file"]]
            self.assertTrue(points)
            self.assertEqual({point["solver"] for point in points}, {"nlgs"})
            iterations = [int(point["iteration"]) for point in points]
            self.assertEqual(iterations, sorted(set(iterations)))
            seconds = [float(point["cpu_seconds"]) for point in points]
            self.assertEqual(seconds, sorted(seconds))
            self.assertLessEqual(float(points[-1]["e1"]), TOLERANCE)

    def test_answers_are_written_once(self):
        file = self.copy("Rover4613")
        self.solve(file, "--write")
        self.assertIn("--force", self.solve(file, "--write", code=2).stderr)
        self.solve(file, "--write", "--force")
        self.solve(file)

    def test_file_that_cannot_be_written(self):
        file = self.copy("Rover4613")
        (self.place / file).chmod(stat.S_IRUSR)
        if os.access(self.place / file, os.W_OK):
            self.skipTest("this user may write all files")
        said = self.solve(file, "--write", code=2).stderr
        self.assertRegex(said, rf"^{file}: error: cannot open the file: .*ermission denied")

    def test_all_solvers(self):
        rows = self.solve_json(PROBLEMS / "Rover1039.hdf5", "--solver", "all")
        self.assertGreater(len(rows), 2)
        self.assertEqual(len({row["solver"] for row in rows}), len(rows))
        for row in rows:
            with self.subTest(solver=row["solver"]):
                self.assertLessEqual(row["e1"], TOLERANCE)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    take_program()
    unittest.main()
