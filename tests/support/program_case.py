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

    def run_program(self, *words, code=0, ranks=1):
        """Run the program in the test's folder, on so many ranks; its exit code must be this one."""
        command, environment = [self.program, *map(str, words)], None
        if ranks > 1:
            command = [self.launcher, "--oversubscribe", "-n", str(ranks), *command]
            environment = {name: value for name, value in os.environ.items() if name != "TMPDIR"}
            environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMP_NUM_THREADS": "1"}
        done = subprocess.run(command, cwd=self.place, capture_output=True, text=True, env=environment,
                              timeout=self.timeout if ranks == 1 else 300)  # fmt: skip
        self.assertEqual(done.returncode, code, f"{words}\n{done.stdout}\n{done.stderr}")
        return done

    def call(self, *words, deck="deck", output="out", code=0, ranks=1):
        """Run a deck of the test's folder, on so many ranks; results of an earlier run are replaced, unless this one goes on from it."""
        force = [] if "--restart" in words else ["--force"]
        return self.run_program("run", f"{deck}.toml", "--output", output, *force, *words, code=code, ranks=ranks)

    def run_deck(self, text, *words, output="out", code=0):
        """Run a deck, given as text, over whatever results there are."""
        (self.place / "deck.toml").write_text(text)
        return self.run_program("run", "deck.toml", "--output", output, "--quiet", "--force", *words, code=code)

    def on_ranks(self, ranks, text, output, *words):
        """Run a deck, given as text, on some ranks; it must end well."""
        (self.place / "deck.toml").write_text(text)
        self.call("--quiet", *words, output=output, ranks=ranks)

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
    """Take the program from the command line, and what starts ranks where it is given."""
    ProgramCase.program = str(Path(sys.argv.pop(1)).resolve())
    if len(sys.argv) > 1 and Path(sys.argv[1]).is_file() and os.access(sys.argv[1], os.X_OK):
        ProgramCase.launcher = sys.argv.pop(1)
