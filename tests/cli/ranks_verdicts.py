"""Verdicts of runs on one rank and on several: the criterion is its own column, converged is below the tolerance, and exchanged momentum
does not diverge."""

import csv
from pathlib import Path

from ranks_case import FALL, Ranks

CRITERIA = ("e1", "e2", "e8", "violation", "estimate", "quad", "maxm", "qm16")
BRICKS = Path(__file__).resolve().parents[2] / "input_decks" / "brick_wall.toml"
OWN_COLUMN = ("e1", "e2", "e8", "violation")
# Two boxes of as many grains: those of the left one lie, those of the right one still fall
HALF = """[time]
step = 1e-3
steps = 45
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.3
[[wall]]
from = [0.0, -0.01]
to = [2.0, -0.01]
thickness = 0.02
[[sample]]
kind = "lattice"
box = [0.0, 0.0, 1.0, 0.4]
radius = [0.02, 0.02]
[[sample]]
kind = "random"
box = [1.0, 2.0, 2.0, 6.0]
radius = [0.02, 0.02]
count = 250
seed = 3
[partition]
boxes = [2, 1]
every = 20
"""


class Verdicts(Ranks):
    def rows(self):
        with open(self.place / "out" / "record.csv", newline="") as file:
            return list(csv.DictReader(file))

    def check_rows(self, criterion, tolerance):
        for row in self.rows():
            if criterion in OWN_COLUMN:
                self.assertEqual(row["criterion"], row[criterion])
            if row["converged"] == "1":
                self.assertLessEqual(float(row["criterion"]), tolerance)

    def test_the_criterion_is_its_own_column(self):
        deck = self.deck(FALL)
        gluings = ("dual", "primal", "momentum")
        for i, criterion in enumerate(CRITERIA):
            # One rank; two ranks or, once each coupling has been on ranks, two subdomains of one process, the same digit by digit.
            two = (2, 0) if i < len(gluings) else (1, 2)
            for (ranks, parts), gluing in (((1, 0), "dual"), (two, gluings[i % len(gluings)])):
                with self.subTest(criterion=criterion, ranks=ranks, parts=parts, gluing=gluing):
                    self.run_ranks(ranks, deck, "--force", "--set", f"solver.criterion={criterion}",
                                   "--set", "solver.tolerance=1e-4",
                                   "--set", f"partition.gluing={gluing}", "--set", "output.record_every=1",
                                   "--set", f"partition.parts={parts}",
                                   "--set", "solver.maximum_sweeps=100", "--set", "time.steps=10")  # fmt: skip
                    self.check_rows(criterion, 1e-4)

    def test_exchanged_momentum_of_bricks_converges(self):
        """Undamped rounds diverged here in steps 11 and 28. This exchange takes no momentum on sweeps, and is judged by the deck's
        criterion alone: the first step, which has no guess, does not have to meet the estimate of cold steps too."""
        for method, ranks, parts in (("nlgs", 4, 0), ("nesterov", 1, 4)):
            with self.subTest(method=method):
                self.run_ranks(ranks, BRICKS, "--force", "--set", f"partition.parts={parts}",
                               "--set", "partition.gluing=momentum", "--set", f"solver.method={method}",
                               "--set", "time.steps=30", "--set", "output.every=0")  # fmt: skip
                self.assertEqual(self.run_json()["unconverged_steps"], 0)

    def test_imbalance_at_splits(self):
        """Splits deal contacts more evenly than they found them: on subdomains of one process as on ranks, bit for bit."""
        found = []
        for ranks, parts in ((1, 2), (2, 0)):
            words = ["--set", f"partition.parts={parts}"] if parts else []
            self.run_ranks(ranks, self.deck(HALF), *words)
            run = self.run_json()
            self.assertGreater(run["splits"], 1)
            self.assertLess(run["imbalance_after_splits"], run["imbalance_before_splits"])
            self.assertLessEqual(1.0, run["imbalance_after_splits"])
            self.assertLessEqual(run["imbalance_before_splits"], 2.0)
            found.append([run[name] for name in ("splits", "imbalance_before_splits", "imbalance_after_splits")])
        self.assertEqual(*found)
        self.run_ranks(1, self.deck(HALF), "--set", "partition.parts=2", "--set", "partition.every=0",
                       "--set", "partition.imbalance=100")  # fmt: skip
        self.assertNotIn("imbalance_after_splits", self.run_json())
