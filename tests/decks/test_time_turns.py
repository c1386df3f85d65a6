#!/usr/bin/env python3
"""Whole runs in turns: a table of their CPU seconds, their ratios by round and their errors: test_time_turns.py PROGRAM"""

import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402
from time_turns import rows_of  # noqa: E402

HERE = Path(__file__).resolve().parent
DECK = HERE.parents[1] / "input_decks/collapsing_column.toml"


class Rows(unittest.TestCase):
    def test_ratios_are_those_of_the_same_round(self):
        summary = {"steps": 10, "contact_updates": 2000, "volume_error": 1e-4}
        one, other = rows_of(["one", "other"], [[1.0, 2.0, 4.0], [0.5, 2.0, 1.0]], [summary, summary])
        self.assertEqual(one, ["one", "1.00", "2.00", "1.000", "1.000", "1.000", "10", "2,000", "1.00e-04"])
        self.assertEqual(other[1:6], ["0.50", "1.00", "0.250", "0.500", "1.000"])


class TimeTurns(ProgramCase):
    def turns(self, *commands):
        words = [sys.executable, HERE / "time_turns.py", "--rounds", "2", *commands]
        return subprocess.run(list(map(str, words)), cwd=self.place, capture_output=True, text=True, timeout=self.timeout)

    def test_runs_of_one_deck(self):
        (self.place / "own.toml").write_text(DECK.read_text())
        (self.place / "run").mkdir()
        # A build without HDF5 makes no pictures.
        command = f"'{self.program}' run own.toml --quiet --set output.every=0 --set restart.every=0 --set time.steps="
        done = self.turns(command + "5", command + "10")
        self.assertEqual(done.returncode, 0, done.stderr)
        head, _, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in done.stdout.splitlines())
        rows = [dict(zip(head, row, strict=True)) for row in rows]
        self.assertEqual([row["steps"] for row in rows], ["5", "10"])
        for row in rows:
            self.assertGreater(float(row["CPU s, least"]), 0)
        self.assertEqual(len(done.stderr.splitlines()), 2)

    def test_a_run_that_fails_ends_it(self):
        done = self.turns(f"'{self.program}' run nowhere.toml --quiet")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("nowhere.toml", done.stderr)
        self.assertEqual(done.stdout, "")

    def test_results_elsewhere_end_it(self):
        done = self.turns(f"'{self.program}' --version")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("leaves 0 files run.json in its folder, not one", done.stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
