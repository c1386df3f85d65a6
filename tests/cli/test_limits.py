#!/usr/bin/env python3
"""Limits of memory and time: a run ends before it takes more than there is, with one sentence and a checkpoint."""

import json
import resource
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

MEGABYTE = 2**20
LIMIT = 300
"""Megabytes of addresses in which crowds have no room; the program takes some thirty at rest"""
HEAD = '[time]\nstep = 1e-3\nsteps = 3\n[[material]]\nname = "stone"\ndensity = 2000.0\n[[law]]\n'
LATTICE = '[[sample]]\nbox = [0.0, 0.0, 5.0, 5.0]\nkind = "lattice"\n'
# All of 6000 disks are neighbours of all others: 18 million pairs, about 400 megabytes.
CROWD = HEAD + "[[interaction]]\nalert = {alert}\n" + LATTICE + "radius = 0.01\ncount = 6000\n"


def gathering(clump):
    """Nine clumps of disks that fly together: a ninth of all pairs are neighbours at first, all are after a few steps."""
    return HEAD + "[[interaction]]\nalert = 10.0\n" + "".join(
        f'[[sample]]\nkind = "lattice"\nradius = 0.01\ncount = {clump}\nbox = [{20 * i}, {20 * j}, {20 * i + 1.2}, {20 * j + 1.2}]\n'
        f"velocity = [{-5000.0 * i}, {-5000.0 * j}]\n" for i in (-1, 0, 1) for j in (-1, 0, 1))


def cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Limits(ProgramCase):
    def write(self, text):
        (self.place / "deck.toml").write_text(text)

    def run_within(self, megabytes, *words, code):
        """Run the program with that many megabytes of addresses."""
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (megabytes * MEGABYTE, megabytes * MEGABYTE))
        done = subprocess.run([self.program, *words], cwd=self.place, capture_output=True, text=True, timeout=self.timeout,
                              preexec_fn=limit)
        self.assertEqual(done.returncode, code, f"{words}\n{done.stdout}\n{done.stderr}")
        self.assertNotIn("Backtrace", done.stderr)
        return done

    def test_pairs_end_the_run_with_a_checkpoint(self):
        self.write(CROWD.format(alert=10.0))
        done = self.run_within(LIMIT, "run", "deck.toml", "--output", "out", "--quiet", code=7)
        self.assertRegex(done.stderr, r'^error: step 1: memory is short: \d+ pairs of neighbours .* do not fit into the .*"ulimit -v" '
                                      r"leaves; .*alert distance of 1.00E\+01 m.*shorter\n$")
        run = json.loads((self.place / "out/run.json").read_text())
        self.assertEqual((run["status"], run["steps"]), ("failed", 0))
        self.assertIn("memory is short", run["reason"])
        if self.has_hdf5():
            self.write(CROWD.format(alert=0.001))
            self.run_within(LIMIT, "run", "deck.toml", "--output", "out", "--restart", "out", "--quiet", code=0)

    def test_growth_in_mid_run_ends_it_with_a_checkpoint(self):
        self.write(gathering(250).replace("steps = 3", "steps = 10"))
        words = ["--dump", "1-10"] if self.has_hdf5() else []
        done = self.run_within(LIMIT, "run", "deck.toml", "--output", "out", "--quiet", *words, code=7)
        self.assertEqual(len([line for line in done.stderr.splitlines() if "error:" in line]), 1, done.stderr)
        run = json.loads((self.place / "out/run.json").read_text())
        self.assertRegex(run["reason"], rf"^step {run['steps'] + 1}: memory is short: \d+ (pairs|contacts)")
        self.assertGreater(run["steps"], 0)
        if self.has_hdf5():
            # The step without a problem leaves no dump, and the state before it a checkpoint.
            self.assertFalse((self.place / f"out/dump-{run['steps'] + 1}-local.hdf5").exists())
            self.assertFalse(list((self.place / "out").glob("*.part")))
            self.run_program("run", "deck.toml", "--output", "out", "--restart", "out", "--quiet", "--set",
                             f"time.steps={run['steps'] + 1}", "--set", "interaction.alert=0.001", code=0)

    def test_check_finds_it_as_well(self):
        self.write(CROWD.format(alert=10.0))
        self.assertIn("pairs of neighbours", self.run_within(LIMIT, "check", "deck.toml", code=7).stderr)
        self.write(CROWD.format(alert=0.001))
        printed = self.run_within(LIMIT, "check", "deck.toml", code=0).stdout
        self.assertRegex(printed, r"memory     about \d+ MB, with \d+ contacts and \d+ pairs")

    def test_samples_beyond_all_bounds_are_refused_at_once(self):
        before = cpu()
        self.write(HEAD + LATTICE.replace("5.0, 5.0", "1.0, 1.0") + "radius = 1e-9\n")
        self.assertIn("this sample would hold 2.3E+17 grains", self.run_program("run", "deck.toml", code=2).stderr)
        self.write(HEAD + LATTICE + "radius = 0.0005\ncount = 5000000\n")
        self.assertIn("needs about 10.0 GB, and \"ulimit -v\" leaves", self.run_within(LIMIT, "check", "deck.toml", code=2).stderr)
        self.assertLess(cpu() - before, 1)

    def test_benchmarks_beyond_all_memory_are_refused_at_once(self):
        before = cpu()
        for words in (["bench", "--contacts", "2000000000"], ["partition", "--lattice", "2000000000", "--parts", "4"]):
            self.assertIn("2000000000 contacts need about 2000.0 GB", self.run_within(LIMIT, *words, code=7).stderr)
        self.assertLess(cpu() - before, 1)

    def test_walltime_holds_while_the_deck_is_read(self):
        # Random insertion into a box that is all but full: half a minute.
        self.write(HEAD + "[[sample]]\nbox = [0.0, 0.0, 5.0, 5.0]\nradius = 0.005\nfill = 0.545\n")
        start = time.monotonic()
        done = self.run_program("run", "deck.toml", "--output", "out", "--walltime", "0.5", "--quiet", code=75)
        self.assertLess(time.monotonic() - start, 10)
        self.assertEqual(done.stderr, "error: stopped by the walltime before the first step; there is no checkpoint\n")

    def test_walltime_holds_in_the_detection(self):
        """The run ends within a detection, with a checkpoint, and still reports the memory of its tables."""
        self.write(CROWD.format(alert=10.0).replace("count = 6000", "count = 20000"))
        start = time.monotonic()
        self.run_program("run", "deck.toml", "--output", "out", "--walltime", "1", "--quiet", "--needs", code=75)
        self.assertLess(time.monotonic() - start, 10)
        run = json.loads((self.place / "out/run.json").read_text())
        self.assertEqual((run["status"], run["reason"], run["steps"]), ("stopped", "stopped by the walltime after step 0", 0))
        if self.has_hdf5():
            self.assertTrue((self.place / "out/restart_a.h5").exists())
        needs = json.loads((self.place / "out/needs.json").read_text())
        self.assertEqual((needs["grains"], needs["contacts"], needs["steps"]), (20000, 0, 0))
        self.assertGreater(needs["bytes_per_grain"], 100)


if __name__ == "__main__":
    take_program()
    unittest.main()
