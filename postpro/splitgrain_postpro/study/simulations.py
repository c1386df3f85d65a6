"""Simulations: a deck run through the program, and what is kept of it."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import ResultsError
from ..results import Results
from .jobs import Job
from .model import HISTORY, Result
from .program import Program, settings_words
from .states import state_folder

if TYPE_CHECKING:
    from .runner import Store

# What is kept of run.json beside the measures.
NUMBERS = ("contact_updates", "sweeps", "steps", "unconverged_steps", "bytes_per_gluing", "gluings", "time", "mean_radius", "contacts")
# Those that a run which goes on from a state counts from the beginning.
SUMS = ("contact_updates", "sweeps", "steps", "unconverged_steps")
# Phases that the answer costs: what is recorded and drawn for the sake of the study is left out.
PHASES = ("cpu_predict", "cpu_detect", "cpu_assemble", "cpu_solve", "cpu_update")


def run_simulation(job: Job, store: Store, program: Program) -> Result:
    """Run a deck; how it ended, its cost, its errors, and what its measures need."""
    settings = {name: value for name, value in job.settings.items() if name not in ("measures", "start")}
    with store.scratch() as place:
        words = ["run", job.case.file.resolve(), "--output", place / "run", "--quiet", "--force"] + settings_words(settings)
        before = {}
        if job.case.start:
            state = state_folder(job, store)
            words += ["--restart", state]
            before = read_run(state)
        code, _, message = program.call(words, job.seconds * settings.get("partition.parts", 1))
        run = read_run(place / "run")
        if code is None:
            return {"status": "time limit", "reason": message, "cpu_seconds": None}
        if code not in (0, 3, 4) or not run:
            return {"status": "failed", "reason": message or f"exit code {code}", "cpu_seconds": None}
        numbers = {name: run.get(name) for name in NUMBERS} | worst_errors(run, place / "run", bool(before))
        numbers |= {name: run[name] - before[name] for name in SUMS if name in run and name in before}
        numbers["cpu_seconds"] = sum((run.get(phase) or 0.0) - (before.get(phase) or 0.0) for phase in PHASES)
        numbers["cpu_solve"] = (run.get("cpu_solve") or 0.0) - (before.get("cpu_solve") or 0.0)
        if run.get("bytes_per_gluing"):
            # A run without sweeps has no gluing, but tests that send: all their bytes count as those of one.
            numbers["bytes"] = run["bytes_per_gluing"] * max(1, run["gluings"])
        if history := history_of(place / "run"):
            numbers["history"] = history
        status = {0: "done", 3: "not converged", 4: "not finite"}[code]
        try:
            series = [series_of(Results(place / "run"), measure) for measure in job.settings["measures"]] if code == 0 else []
        except ResultsError as error:
            return {"status": "failed", "reason": str(error).replace(str(place / "run"), "the run"), "cpu_seconds": None}
        return {"status": status, "reason": run.get("reason") or "", **numbers, "series": series}


def read_run(folder: Path) -> dict:
    """run.json, empty when there is none."""
    try:
        return json.loads((folder / "run.json").read_text())
    except (OSError, ValueError):
        return {}


def history_of(folder: Path) -> list[list[float]]:
    """Effort, E8 of the whole problem and messages (HISTORY) within the last step that was traced; nothing where none was."""
    try:
        with open(folder / "trace.csv", newline="") as file:
            rows = list(csv.DictReader(file))
    except OSError:
        return []
    return [[float(row[name]) if name in ("cpu_seconds", "e8") else int(row[name]) for name in HISTORY] for row in rows
            if row["step"] == rows[-1]["step"]]  # fmt: skip


def worst_errors(run: dict, folder: Path, goes_on: bool) -> dict[str, float | None]:
    """Errors of the worst step; of a run that goes on, of the worst step recorded."""
    if not goes_on:
        return {name: run.get(f"worst_{name}") for name in ("e1", "e2", "e8")}
    record = Results(folder).record
    return {name: float(np.max(record[name])) for name in ("e1", "e2", "e8") if len(record.get(name, ()))}


def series_of(results: Results, measure: dict) -> list[list]:
    """Times and values of a measure: those of the end alone where this is all that is asked for."""
    if measure["bodies"]:
        return all_bodies(results, measure["bodies"])
    if measure["below"]:
        return [[results.run["time"]], [time_below(results.record, measure["column"], measure["below"])]]
    if measure["body"]:
        times, values = positions(results, measure["body"], "xyz".index(measure["component"]))
    elif measure["over"] == "end":
        value = results.run.get(measure["column"])
        if not isinstance(value, int | float):
            raise ResultsError(f"there is no number '{measure['column']}' in run.json")
        return [[results.run["time"]], [value]]
    else:
        if measure["column"] not in results.record:
            raise ResultsError(f"there is no column '{measure['column']}' in record.csv")
        times, values = results.record["time"], results.record[measure["column"]]
    if not len(times):
        raise ResultsError(f"nothing of {measure['column'] or 'the body'} is recorded")
    keep = slice(-1, None) if measure["over"] == "end" else slice(None)
    return [np.asarray(times, float)[keep].tolist(), np.asarray(values, float)[keep].tolist()]


def time_below(record: dict[str, np.ndarray], column: str, limit: float) -> float:
    """The time from which a column stays below a limit, to a step; that of the end where it does not."""
    if column not in record or not len(record[column]):
        raise ResultsError(f"there is no column '{column}' in record.csv, or no row")
    above = np.flatnonzero(~(record[column] < limit))
    if not len(above):
        return float(record["time"][0])
    return float(record["time"][min(above[-1] + 1, len(record["time"]) - 1)])


def all_bodies(results: Results, what: str) -> list[list]:
    """Positions or velocities of all bodies at the end, by number, one after the other."""
    if results.bodies is None:
        raise ResultsError("no picture was taken: is this a build without HDF5?")
    grid = results.bodies.step(len(results.bodies.times) - 1)
    order = np.argsort(grid.point_data["id"])
    values = grid.points if what == "position" else grid.point_data["velocity"]
    return [[float(grid.time)], [np.asarray(values, float)[order].ravel().tolist()]]


def positions(results: Results, body: int, component: int) -> tuple[list[float], list[float]]:
    """Where the pictures show a body."""
    if results.bodies is None:
        raise ResultsError("no picture was taken: is this a build without HDF5?")
    times, values = [], []
    for index in range(len(results.bodies.times)):
        grid = results.bodies.step(index)
        rows = np.flatnonzero(grid.point_data["id"] == body)
        if not len(rows):
            raise ResultsError(f"there is no body {body}")
        times.append(float(grid.time))
        values.append(float(grid.points[rows[0], component]))
    return times, values
