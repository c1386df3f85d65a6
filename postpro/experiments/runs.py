"""Runs of shipped decks for the studies: each in a folder of its own, made once."""

import csv
import json
import os
import subprocess
from pathlib import Path

import numpy as np

DECKS = Path(__file__).resolve().parents[2] / "input_decks"
ROOT_IS_MEANT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}

# What the talk counts is plain sweeps, tested every twentieth.
PLAIN_SWEEPS = {"method": '"nlgs"', "check_every": 20}

# Okabe and Ito (2008): distinguished by colour-blind people.
BLACK, ORANGE, GREEN, BLUE, VERMILION = "#000000", "#E69F00", "#009E73", "#0072B2", "#D55E00"


class Runner:
    """Runs decks on ranks, each run in a folder of its own that stays."""

    def __init__(self, program, folder, launcher, solver=PLAIN_SWEEPS):
        self.solver = solver
        self.program, self.folder, self.launcher = str(Path(program).resolve()), Path(folder), launcher.split()
        self.folder.mkdir(parents=True, exist_ok=True)

    def run(self, name, deck, ranks=1, state=None, **sections):
        """Run a deck by the solver of this runner, with `section={key: value}` laid over it, unless that was done; returns the folder of its
        results."""
        results = self.folder / name
        if (results / "run.json").exists() and json.loads((results / "run.json").read_text())["status"] == "done":
            return results
        words = [self.program, "run", str(DECKS / deck), "--output", str(results), "--quiet", "--force"]
        if ranks > 1:
            words = self.launcher + [str(ranks)] + words
        if state:
            words += ["--restart", str(state)]
        sections["solver"] = self.solver | sections.get("solver", {})
        for section, keys in sections.items():
            for key, value in keys.items():
                words += ["--set", f"{key}={value}" if section == "anywhere" else f"{section}.{key}={value}"]
        print(name, flush=True)
        subprocess.run(words, check=True, env=os.environ | ROOT_IS_MEANT)
        return results

    def write(self, name, rows):
        """Write rows, dictionaries of the same keys, as CSV and as a Markdown table."""
        with open(self.folder / f"{name}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)
        lines = ["| " + " | ".join(rows[0]) + " |", "|" + "---|" * len(rows[0])]
        lines += ["| " + " | ".join(str(v) for v in row.values()) + " |" for row in rows]
        (self.folder / f"{name}.md").write_text("\n".join(lines) + "\n")


def record(results):
    """Columns of the record of a run."""
    return np.genfromtxt(results / "record.csv", delimiter=",", names=True)


def summary(results):
    """Summary of a run."""
    return json.loads((results / "run.json").read_text())


def newest(results):
    """The newest restart file of a run."""
    return max(results.glob("restart_*.h5"), key=lambda path: path.stat().st_mtime)
