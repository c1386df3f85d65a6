"""Tests of the program from outside, each in a folder of its own whose name has a blank."""

import csv
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path


class ProgramCase(unittest.TestCase):
    program = None
    launcher = None
    """Program that starts ranks; None in a build without MPI"""
    timeout = 120
    """Seconds that a call may take"""

    def setUp(self):
        place = tempfile.TemporaryDirectory(prefix="splitgrain ")
        self.addCleanup(place.cleanup)
        self.place = Path(place.name)

    def run_program(self, *words, code=0):
        """Run the program in the test's folder; its exit code must be this one."""
        done = subprocess.run([self.program, *map(str, words)], cwd=self.place, capture_output=True, text=True,
                              timeout=self.timeout)
        self.assertEqual(done.returncode, code, f"{words}\n{done.stdout}\n{done.stderr}")
        return done

    def on_ranks(self, ranks, text, output, *words):
        """Run a deck, given as text, on some ranks; it must end well."""
        (self.place / "deck.toml").write_text(text)
        environment = {name: value for name, value in os.environ.items() if name != "TMPDIR"}
        environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        done = subprocess.run([self.launcher, "--oversubscribe", "-n", str(ranks), self.program, "run", "deck.toml", "--output", output,
                               "--force", "--quiet", *words], cwd=self.place, capture_output=True, text=True, env=environment, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)

    def rows(self, output="out", file="record.csv"):
        """Rows of a file of results, without the costs of steps, which differ from run to run."""
        with (self.place / output / file).open(newline="") as lines:
            return [{name: value for name, value in row.items() if not name.startswith(("cpu_", "wall_"))} for row in csv.DictReader(lines)]

    def run_until_walltime(self, run, *words):
        """Call `run`, which wants exit code 75, with a walltime that doubles while the machine is too busy for a first step."""
        for seconds in (0.25 * 2**i for i in range(8)):
            done = run(*words, "--walltime", str(seconds), code=75)
            if "before the first step" not in done.stderr:
                return done
        self.fail(f"no step within {seconds} s")

    def has_library(self, name):
        return re.search(rf"^{name}\s+on", self.run_program("--version").stdout, re.M) is not None

    def has_hdf5(self):
        return self.has_library("HDF5")


def take_program():
    """Take the program from the command line."""
    ProgramCase.program = str(Path(sys.argv.pop(1)).resolve())
