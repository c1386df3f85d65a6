"""Contact problems: made by decks where they are not there, solved once for reference, and by every variant."""

from __future__ import annotations

import csv
import json
import os
import shutil
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import numpy as np

from ..errors import StudyError
from .jobs import Job, fingerprint
from .model import Case, Result, Study
from .program import Program, json_lines, settings_words

if TYPE_CHECKING:
    from .runner import Store

# Impulses and velocities of contacts, by name.
Answer = dict[str, np.ndarray]
# Points of a trace that are kept.
TRACE_POINTS = 80


class ProblemRunner:
    """Solves the problems of a study."""

    def __init__(self, study: Study, store: Store, program: Program):
        self.study, self.store, self.program = study, store, program
        self.files, self.answers, self.lock = {}, {}, threading.Lock()

    def prepare(self, case: Case) -> None:
        """Have the file of a case, and its reference solution."""
        self.files[case.name] = self.dumped(case) if case.dump else case.file
        if self.study.reference:
            self.answers[case.name] = self.reference(case)

    def dumped(self, case: Case) -> Path:
        """The problem that a deck meets at a step, in local form."""
        name = Job(case, None, 0, 0, fingerprint(case.file), 0, self.program.digest, case.settings).key
        target = self.store.folder / "problems" / f"{name}.hdf5"
        if target.exists():
            return target
        with self.store.scratch() as place:
            words = ["run", case.file.resolve(), "--output", place / "run", "--quiet", "--force", "--dump", case.dump, "--set",
                     f"time.steps={case.dump}", "--set", "output.every=0"]  # fmt: skip
            code, _, message = self.program.call(words + settings_words(case.settings), 20 * self.study.seconds)
            made = place / "run" / f"dump-{case.dump}-local.hdf5"
            if not made.exists():
                raise StudyError(f"step {case.dump} of {case.file.name} made no contact problem: {message or f'exit code {code}'}",
                                 self.study.path)  # fmt: skip
            os.replace(made, target)
        return target

    def reference(self, case: Case) -> Answer | None:
        """Impulses and velocities of the reference solution, solved once; None where it does not arrive."""
        asked = self.study.reference
        what = json.dumps(asked, sort_keys=True)
        job = Job(case, None, 0, -1, fingerprint(case.file), self.study.seconds, self.program.digest, case.settings, what)
        kept = self.store.load(job.key)
        if kept is None:
            row, answer, status, _ = self.call(case, asked["solver"], asked["tolerance"], 3 * self.study.seconds)
            if status == "failed":
                return None
            kept = {"status": status, "e1": row.get("e1"), "answer": {k: v.tolist() for k, v in answer.items()}}
            self.store.save(job.key, kept)
        return {name: np.array(values) for name, values in kept["answer"].items()} or None

    def solve(self, job: Job) -> Result:
        """Solve a problem by a variant."""
        variant, options = job.variant, []
        if variant.guess:
            options += ["--guess"]
        if variant.iterations:
            options += ["--iterations", variant.iterations]
        row, answer, status, message = self.call(job.case, variant.solver, job.value, job.seconds, options, job.repeat == 0)
        numbers = {name: row.get(name) for name in ("contacts", "iterations", "sweeps", "factorisations", "cpu_seconds", "e1",
                                                    "e2", "e8")}  # fmt: skip
        # Where factorisations do the work, contact updates would not measure it.
        updates = (row.get("sweeps") or 0) * (row.get("contacts") or 0)
        numbers["contact_updates"] = updates if updates and not row.get("factorisations") else None
        numbers["distance"] = distance(answer, self.answers.get(job.case.name))
        return {"status": status, "reason": message, **numbers, "trace": row.get("trace", [])}

    def call(
        self, case: Case, solver: str, tolerance: float, seconds: float, options: Sequence = (), with_trace: bool = False,
    ) -> tuple[Result, Answer, str, str]:
        """Solve a copy of a problem; what is printed of it, its answer, how it ended and why."""
        with self.store.scratch() as place:
            copy = place / "problem.hdf5"
            shutil.copyfile(self.files[case.name], copy)
            words = ["solve", copy, "--solver", solver, "--tolerance", repr(float(tolerance)), "--seconds", seconds, "--json",
                     "--write", "--force", *options]  # fmt: skip
            if with_trace:
                words += ["--trace", place / "trace.csv"]
            # Reading and condensing the problem is beside the solver's own limit.
            code, printed, message = self.program.call(words, 2 * seconds + 10)
            row = next(iter(json_lines(printed)), {})
            if code is None:
                return row, {}, "time limit", message
            if code not in (0, 3) or "error" in row:
                return row, {}, "failed", row.get("error") or message or f"exit code {code}"
            if with_trace:
                row["trace"] = trace_of(place / "trace.csv")
            return row, answer_of(copy), "solved" if row["converged"] else "not solved", ""


def answer_of(path: Path) -> Answer:
    """Impulses and velocities of the solution in a file, and the free velocities of its contacts, where they are given."""
    found = {}
    with h5py.File(path) as file:
        for name, place in (("r", "solution/r"), ("u", "solution/u"), ("q", "fclib_local/vectors/q")):
            if place in file:
                found[name] = file[place][()]
    return found


def distance(answer: Answer, reference: Answer | None) -> float | None:
    """Energy norm of the difference of velocities, sqrt(dr.du), over that of what contacts change; None where not known."""
    if not reference or not {"r", "u"} <= answer.keys() or not {"r", "u", "q"} <= reference.keys():
        return None
    scale = reference["r"] @ (reference["u"] - reference["q"])
    difference = (answer["r"] - reference["r"]) @ (answer["u"] - reference["u"])
    return float(np.sqrt(abs(difference) / scale)) if np.isfinite(difference) and scale > 0 else None


def trace_of(path: Path) -> list[list[float]]:
    """CPU seconds, e1 and e8 of a trace, thinned."""
    with open(path, newline="") as file:
        points = [[float(row[name]) for name in ("cpu_seconds", "e1", "e8")] for row in csv.DictReader(file)]
    if len(points) <= TRACE_POINTS:
        return points
    return [points[i] for i in np.unique(np.geomspace(1, len(points), TRACE_POINTS).astype(int) - 1)]
