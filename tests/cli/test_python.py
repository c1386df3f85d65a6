#!/usr/bin/env python3
"""Python that the program and `./start` start must not run what lies in the current folder.

usage: test_python.py PROGRAM [unittest options]
"""

import os
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

SOURCE = Path(__file__).resolve().parents[2]

TRAPS = ["csv", "json", "numpy", "h5py", "matplotlib", "importlib", "sys", "os", "splitgrain_postpro", "ast", "tomllib", "argparse", "pathlib"]


class Python(ProgramCase):
    def setUp(self):
        super().setUp()
        for name in TRAPS:
            (self.place / f"{name}.py").write_text(f"open('{name}.ran', 'w')\nraise SystemExit(99)\n")

    def start(self, *words):
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        done = subprocess.run(list(map(str, words)), cwd=self.place, capture_output=True, text=True, timeout=self.timeout, env=environment)
        self.assertEqual([trap.name for trap in self.place.glob("*.ran")], [], f"{words}: {done.stdout}{done.stderr}")
        return done

    def test_the_traps_work(self):
        subprocess.run(["python3", "-c", "import csv"], cwd=self.place, check=False)
        self.assertTrue((self.place / "csv.ran").exists())

    def test_study(self):
        done = self.start(self.program, "study", "nowhere.toml")
        self.assertIn("study", done.stderr + done.stdout)
        if "and none was found" not in done.stderr:
            self.assertIn("nowhere.toml", done.stderr)

    def test_convert(self):
        (self.place / "DATBOX").mkdir()
        (self.place / "command.py").write_text("SetTimeStep(1e-3)\nopen('command.ran', 'w')\n")
        self.assertNotEqual(self.start(self.program, "convert", "DATBOX", "deck.toml").returncode, 0)

    def test_look(self):
        if subprocess.run(["/usr/bin/env", "python3", "-P", "-c", "import h5py, matplotlib, numpy, pytest"], capture_output=True).returncode and \
                subprocess.run(["/usr/bin/python3", "-P", "-c", "import h5py, matplotlib, numpy, pytest"], capture_output=True).returncode:
            self.skipTest("no Python with h5py, matplotlib, numpy and pytest")
        done = self.start(SOURCE / "start", "look", "summary", "nowhere.results")
        self.assertIn("nowhere.results", done.stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
