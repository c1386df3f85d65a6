"""How runs on several ranks end: steps that break or do not converge, dumps, signals, the walltime."""

import json
import math
import os
import re
import signal
import subprocess
import time
from pathlib import Path

from ranks_case import BEYOND, FALL, PRESSED, Ranks
from test_limits import CROWD


class Breaks(Ranks):
    def test_bodies_beyond_all_numbers_are_named(self):
        if "ffpe-trap" in self.run_program("--version").stdout:
            self.skipTest("this build stops where numbers overflow")
        deck = self.deck(BEYOND)
        said = "step 1: velocities without contacts, from forces and drives, are not finite of bodies 9;"
        for ranks in (1, 3):
            self.refused(ranks, deck, said, code=4)
            self.assertEqual(self.run_json()["status"], "failed")
            self.assertRegex(self.run_json()["reason"], said)
        if self.has_hdf5():
            # The checkpoint is of the state before.
            self.refused(2, deck, said, "--restart", "out", code=4)

    def test_a_step_that_does_not_converge(self):
        deck = self.deck(FALL)
        hard = ["--set", "solver.maximum_sweeps=1", "--set", "solver.tolerance=1e-14", "--set", "solver.check_every=1"]
        self.run_ranks(3, deck, *hard, "--set", "solver.stop_unconverged=true", code=3)
        self.assertEqual(self.run_json()["status"], "not converged")
        if self.has_hdf5():
            # All ranks together leave the problem of the step.
            step = self.run_json()["steps"]
            self.assertEqual(self.run_json()[f"file_dump_{step}"], f"dump-{step}-local.hdf5")
            self.solve_all(["out"], [f"dump-{step}"])

    def solve_all(self, folders, names):
        """Solve both forms of dumps; number of contacts by file."""
        files = [f"{folder}/{name}-{form}.hdf5" for folder in folders for name in names for form in ("local", "global")]
        lines = [json.loads(line) for line in self.run_program("solve", *files, "--json").stdout.splitlines()]
        self.assertEqual([line["file"] for line in lines], files)
        self.assertLess(max(line["e1"] for line in lines), 1e-8)
        return [line["contacts"] for line in lines]

    def test_dumps_hold_the_whole_problem(self):
        if not self.has_hdf5():
            self.skipTest("built without HDF5")
        deck = self.deck(PRESSED)
        for ranks in (1, 3):
            self.run_ranks(ranks, deck, "--dump", "40,50-51", output=f"on {ranks}")
        names = ["dump-40", "dump-50", "dump-51"]
        one, many = (self.solve_all([f"on {ranks}"], names) for ranks in (1, 3))
        self.assertGreater(min(one), 0)
        self.assertEqual(one, many)

    def test_a_structure_that_cannot_be_written(self):
        """The one rank that writes it tells the others, which would wait for it in the next step."""
        if not self.has_library("FFTW"):
            self.skipTest("built without FFTW")
        (self.place / "out" / "structure_factor.csv.part").mkdir(parents=True)
        words = ["--set", "report.structure=true", "--set", "report.structure_every=5"]
        self.refused(3, self.deck(FALL), "structure_factor.csv.part: error: cannot open the file", *words, code=5)
        self.assertEqual(self.run_json()["status"], "failed")
        self.assertEqual(self.run_json()["steps"], 5)


class Stops(Ranks):
    def start(self, ranks, **environment):
        """Start a run that would last for hours, and wait until it has written both its restart files."""
        every = [] if not self.has_hdf5() else ["--set", "restart.every=50"]
        program = subprocess.Popen(
            [self.launcher, "--oversubscribe", "-n", str(ranks), self.program, "run", self.deck(FALL),
             "--set", "time.steps=100000000", "--set", "output.record_every=20", "--quiet", "--output", "out", *every],
            cwd=self.place, env=self.environment | environment, text=True, stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE)  # fmt: skip
        self.addCleanup(program.stderr.close)
        self.addCleanup(program.kill)
        last = self.place / "out" / ("restart_b.h5" if every else "record.csv")
        end = time.monotonic() + self.timeout
        while not last.exists():
            self.assertLess(time.monotonic(), end, "nothing happens")
            time.sleep(0.02)
        return program

    def ranks_of(self, program):
        """Process numbers of the ranks that a launcher has started."""
        names = Path(f"/proc/{program.pid}/task/{program.pid}/children").read_text().split()
        return [int(name) for name in names if Path(f"/proc/{name}/comm").read_text().strip() == Path(self.program).name[:15]]

    def test_a_rank_short_of_memory_ends_all_with_a_checkpoint(self):
        crowd = CROWD.replace("count = 6000", "count = 5000")
        part = [1, "run", self.deck(crowd.format(alert=10.0)), "--output", "out", "--quiet"]
        done = self.launch(part, part, code=7, starter=["bash", "-c", 'ulimit -v 350000; exec "$0" "$@"'])
        self.assertEqual(len(re.findall("^error: ", done.stderr, re.M)), 1, done.stderr)
        self.assertRegex(done.stderr, r'error: step 1: memory is short: \d+ pairs of neighbours .* "ulimit -v" leaves')
        self.assertEqual(json.loads((self.place / "out/run.json").read_text())["status"], "failed")
        if self.has_hdf5():
            self.deck(crowd.format(alert=0.001))
            self.launch([2, *part[1:], "--restart", "out"])

    def test_a_rank_that_is_killed_takes_the_others_with_it(self):
        program = self.start(3)
        ranks = self.ranks_of(program)
        self.assertEqual(len(ranks), 3)
        os.kill(ranks[1], signal.SIGKILL)
        self.assertEqual(program.wait(self.timeout), 128 + signal.SIGKILL)
        self.assertIn("exited on signal 9", program.stderr.read())
        for rank in ranks:
            self.assertFalse(Path(f"/proc/{rank}/exe").exists(), "a rank goes on")
        if not self.has_hdf5():
            return
        for ranks in (2, 4, 1):
            self.run_until_walltime(self.run_ranks, ranks, "deck.toml", "--restart", "out", "--set", "time.steps=100000000")
            self.assertTrue(all(math.isfinite(float(row["kinetic_energy"])) for row in self.rows()))
            steps = [int(row["step"]) for row in self.rows()]
            self.assertEqual(steps, sorted(set(steps)))

    def test_a_signal_to_one_rank_stops_all_with_a_checkpoint(self):
        program = self.start(3)
        os.kill(self.ranks_of(program)[2], signal.SIGTERM)
        self.assertEqual(program.wait(self.timeout), 75)
        run = self.run_json()
        self.assertEqual((run["status"], run["reason"]), ("stopped", f"stopped by signal 15 after step {run['steps']}"))
        if self.has_hdf5():
            self.run_ranks(2, "deck.toml", "--restart", "out", "--set", f"time.steps={run['steps'] + 1}")
            self.assertEqual(self.run_json()["steps"], run["steps"] + 1)

    def test_a_signal_to_the_launcher_stops_all_with_a_checkpoint(self):
        # Ranks write their checkpoint within the second after SIGTERM that Open MPI gives them by default.
        program = self.start(2, OMPI_MCA_odls_base_sigkill_timeout="1")
        program.send_signal(signal.SIGTERM)
        # Its exit code is the launcher's own.
        self.assertNotEqual(program.wait(self.timeout), 0)
        self.assertEqual(self.run_json()["status"], "stopped")

    def test_walltime(self):
        deck = self.deck(FALL)
        words = ["--set", "time.steps=100000000", "--set", "output.record_every=0"]
        done = self.run_until_walltime(self.run_ranks, 3, deck, *words)
        self.assertEqual(done.stdout, "")
        run = self.run_json()
        self.assertEqual((run["status"], run["reason"]), ("stopped", f"stopped by the walltime after step {run['steps']}"))
        if self.has_hdf5():
            self.run_ranks(2, deck, "--restart", "out", "--set", f"time.steps={run['steps'] + 1}")
