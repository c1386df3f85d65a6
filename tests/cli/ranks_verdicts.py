"""Verdicts of runs on one rank and on several: the criterion is its own column, converged is below the tolerance, and exchanged momentum
does not diverge."""

import csv
from pathlib import Path

from ranks_case import FALL, Ranks

CRITERIA = ("e1", "e2", "e8", "violation", "estimate", "quad", "maxm", "qm16")
BRICKS = Path(__file__).resolve().parents[2] / "input_decks" / "brick_wall.toml"
OWN_COLUMN = ("e1", "e2", "e8", "violation")


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
        for i, criterion in enumerate(CRITERIA):
            for ranks, gluing in ((1, "dual"), (2, ("dual", "primal", "momentum")[i % 3])):
                with self.subTest(criterion=criterion, ranks=ranks, gluing=gluing):
                    self.run_ranks(ranks, deck, "--force", "--set", f"solver.criterion={criterion}", "--set", "solver.tolerance=1e-4",
                                   "--set", f"partition.gluing={gluing}", "--set", "output.record_every=1",
                                   "--set", "solver.maximum_sweeps=100", "--set", "time.steps=10")  # fmt: skip
                    self.check_rows(criterion, 1e-4)

    def test_exchanged_momentum_of_bricks_converges(self):
        """Undamped rounds diverged here in steps 11 and 28. This exchange takes no momentum on sweeps, and is judged by the deck's
        criterion alone: the first step, which has no guess, does not have to meet the estimate of cold steps too."""
        for method in ("nlgs", "nesterov"):
            with self.subTest(method=method):
                self.run_ranks(4, BRICKS, "--force", "--set", "partition.gluing=momentum", "--set", f"solver.method={method}",
                               "--set", "time.steps=30", "--set", "output.every=0")  # fmt: skip
                self.assertEqual(self.run_json()["unconverged_steps"], 0)
