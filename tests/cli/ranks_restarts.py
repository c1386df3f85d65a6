"""Checkpoints on several ranks: other numbers of ranks, other steps, a full disk."""

import subprocess

from ranks_case import COMMON, DRIVES, FALL, FLOOR, GRAPH, PRESSED, SIDES, Ranks, grains


class Restarts(Ranks):
    def setUp(self):
        super().setUp()
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")

    def test_numbers_of_ranks_may_change(self):
        """Impulses of this pack are not unique: plain sweeps find the same ones on all numbers of ranks, momentum others within 1e-2.
        Pushes end before they are solved as far as a step, and are left out."""
        deck = self.deck(PRESSED + DRIVES)
        every = ["--set", "restart.every=30", "--set", "solver.method=nlgs", "--set", "time.recovery=0"]
        self.run_ranks(1, deck, *every, "--set", "time.steps=120", output="straight")
        split = GRAPH if self.has_library("METIS") else ["--set", "partition.boxes=[3, 1]"]
        for part, (ranks, words) in enumerate(((1, []), (3, split), (2, ["--set", 'partition.gluing="primal"']), (1, []))):
            on = ["--restart", "parts"] if part else []
            self.run_ranks(ranks, deck, *every, *words, *on, "--set", f"time.steps={30 * (part + 1)}", output="parts")
        straight, parts = self.run_json("straight"), self.run_json("parts")
        self.assertEqual((straight["steps"], straight["contacts"]), (parts["steps"], parts["contacts"]))
        # Sums over the whole run, each to the tolerance of the steps.
        self.compare(straight, parts, 1e-5, {"potential_energy": 1.0, "impact_loss": 1.0, "friction_loss": 1.0,
                                             "external_work": 1.0, "drive_work": 1.0})  # fmt: skip
        self.assertEqual([row["step"] for row in self.rows("straight")], [row["step"] for row in self.rows("parts")])
        (bodies, contacts), (others, impulses) = self.state(deck, "straight"), self.state(deck, "parts")
        self.assertEqual(len(bodies), len(others))
        self.assertLess(max(abs(a - b) for a, b in zip(bodies, others)), 1e-5)
        self.assertEqual(contacts.keys(), impulses.keys())
        largest = max(max(forces) for forces in contacts.values())
        for pair, forces in contacts.items():
            for force, other in zip(forces, impulses[pair], strict=True):
                self.assertAlmostEqual(force, other, delta=1e-3 * largest, msg=f"{pair}")

    def test_time_goes_on_with_another_step(self):
        deck = self.deck(PRESSED + DRIVES)
        every = ["--set", "restart.every=30", "--set", "output.record_every=1"]
        for ranks, others in ((1, 3), (3, 1)):
            with self.subTest(ranks=ranks):
                self.run_ranks(ranks, deck, *every, "--set", "time.steps=30", output=f"of {ranks}")
                for total, step, on in ((50, 5e-4, others), (60, 2e-3, ranks)):
                    self.run_ranks(on, deck, *every, "--set", f"time.steps={total}", "--set", f"time.step={step}",
                                   "--set", "restart.every=10", "--restart", f"of {ranks}", output=f"of {ranks}")  # fmt: skip
                times = [float(row["time"]) for row in self.rows(f"of {ranks}")]
                steps = [b - a for a, b in zip(times, times[1:])]
                self.assertEqual(len(times), 60)
                for got, asked in zip(steps, 29 * [1e-3] + 20 * [5e-4] + 10 * [2e-3], strict=True):
                    self.assertAlmostEqual(got, asked, delta=1e-12)

    def test_friction_comes_and_goes(self):
        """A stage with friction after one without, and one without again, on one rank and on several: velocities agree to what steps of
        tolerance 1e-9 leave of 1 m/s."""
        deck = self.deck("[scene]\ngravity = [4.0, -9.0]\n" + COMMON + FLOOR + SIDES + grains(120))
        tight = ["--set", "solver.method=nlgs", "--set", "solver.criterion=e8", "--set", "solver.tolerance=1e-9"]
        smooth = [*tight, "--set", "law[1].friction=0"]
        self.run_ranks(1, deck, *smooth, output="smooth")
        states = []
        for ranks in (1, 3):
            self.run_ranks(ranks, deck, *tight, "--set", "time.steps=70", "--restart", "smooth", output=f"rough {ranks}")
            self.run_ranks(4 - ranks, deck, *smooth, "--set", "time.steps=80", "--restart", f"rough {ranks}", output=f"on {ranks}")
            self.assertLess(self.run_json(f"on {ranks}")["energy_closure"], 1e-9)
            states.append(self.state(deck, f"on {ranks}")[0])
        self.assertLess(max(abs(a - b) for a, b in zip(*states, strict=True)), 1e-6)
        self.assertGreater(max(abs(spin) for spin in states[0][5::6]), 1e-2)

    def test_nothing_left_to_do(self):
        deck = self.deck(FALL)
        self.run_ranks(1, deck, "--set", "restart.every=60")
        self.run_ranks(3, deck, "--restart", "out", "--set", "restart.every=60")
        self.assertEqual((self.run_json()["status"], self.run_json()["steps"]), ("done", 60))

    def fill(self, path):
        """Leave room for a few small texts alone on a disk."""
        with open(path, "wb", buffering=0) as file:
            try:
                while True:
                    file.write(bytes(4096))
            except OSError:
                file.truncate(max(0, file.tell() - 4096))

    def test_files_that_a_killed_run_left_open_are_closed(self):
        """A run killed after its last checkpoint, before it wrote its summary, has the numbers of the run that was not."""
        deck = self.deck(PRESSED)
        for ranks, every in ((1, 0), (1, 7), (2, 7)):
            with self.subTest(ranks=ranks, every=every):
                words = ["--set", f"output.record_every={every}", "--set", "time.steps=20"]
                self.run_ranks(ranks, deck, *words)
                ended, folder = self.run_json(), self.place / "out"
                numbers = (folder / "numbers.tag").read_text()
                for name in ("run.json", "numbers.tag"):
                    (folder / name).unlink()
                self.run_ranks(ranks, deck, *words, "--restart", "out")
                self.assertEqual((folder / "numbers.tag").read_text(), numbers)
                for name in ("status", "steps", "time", "kinetic_energy", "file_restart"):
                    self.assertEqual(self.run_json()[name], ended[name], name)

    def test_full_disk(self):
        small = self.place / "small"
        small.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", small], capture_output=True).returncode:
            self.skipTest("no small disk can be mounted here")
        self.addCleanup(subprocess.run, ["umount", small], capture_output=True)
        deck = self.deck(COMMON + FLOOR + grains(120))
        words = ["--set", "restart.every=5", "--set", "output.record_every=0"]
        self.run_ranks(2, deck, *words, "--set", "time.steps=20", output="small/out")
        for ranks in (3, 1):
            with self.subTest(ranks=ranks):
                self.fill(small / "fill")
                done = self.run_ranks(ranks, deck, *words, "--restart", "small/out", code=5, output="small/out")
                self.assertEqual(done.stderr.count("error:"), 1, done.stderr)
                self.assertRegex(done.stderr, "restart_[ab].*cannot write|No space left on device")
                self.assertEqual(done.stdout, "")
                (small / "fill").unlink()
                self.run_ranks(1, deck, "--restart", "small/out", "--set", "time.steps=30", output="on")
                self.assertEqual(self.run_json("on")["steps"], 30)
