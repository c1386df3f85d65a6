"""What a run did, and whether it holds: finite, converged, energy not created, penetration bounded, right where known."""

import hashlib
import json
import math
from dataclasses import dataclass

import numpy as np

from ..errors import ResultsError
from ..results import Results
from .expressions import evaluate
from .jobs import fingerprint
from .model import Case, Result, Variant
from .program import Program, settings_words
from .runner import Store
from .simulations import PHASES, read_run
from .verdict_file import VerdictStudy

# Raise this when what a result file holds changes its meaning.
FORMAT = "verdict 2"
STATUS = {0: "done", 2: "refused", 3: "not converged", 4: "not finite"}
LOSSES = ("friction_loss", "impact_loss")
WORKS = ("external_work", "drive_work")


@dataclass
class VerdictJob:
    """One run whose verdict is wanted."""

    case: Case
    variant: Variant
    value: float | None
    settings: dict
    bodies: list
    seconds: float
    program: str
    content: str

    @property
    def key(self) -> str:
        """Name of the result file: the same for the same work."""
        what = [FORMAT, self.program, self.content, self.settings, self.bodies, self.seconds]
        return hashlib.sha256(json.dumps(what, sort_keys=True).encode()).hexdigest()[:20]

    @property
    def label(self) -> str:
        """What is printed while it runs."""
        return f"{self.case.name}, {self.variant.name}" + ("" if self.value is None else f", {self.value:g}")


# A run with its result and its verdict; all of them, by case and variant.
Point = tuple[VerdictJob, Result, Result]
Verdicts = dict[tuple[str, str], list[Point]]


def job_of(study: VerdictStudy, case: Case, variant: Variant, value: float | None, program: Program) -> VerdictJob:
    """The run of a case by a variant at a value of the parameter."""
    return VerdictJob(case, variant, value, study.settings(case, variant, value), study.bodies(case), study.seconds,
                      program.digest, fingerprint(case.file))  # fmt: skip


def run_verdict(job: VerdictJob, store: Store, program: Program) -> Result:
    """Run a deck and keep what verdicts are made of."""
    settings = dict(job.settings)
    if job.bodies:
        settings.setdefault("output.every", 1000000000)
    with store.scratch() as place:
        words = ["run", job.case.file.resolve(), "--output", place / "run", "--quiet", "--force"] + settings_words(settings)
        code, _, message = program.call(words, job.seconds)
        run = read_run(place / "run")
        if code is None:
            return {"status": "time limit", "reason": f"{job.seconds:g} CPU seconds were not enough", "code": None}
        message = message.replace(str(place), "").removeprefix("error: ")
        if code < 0 or code not in STATUS and code > 5:
            return {"status": "crashed", "reason": message or f"ended by signal {-code}", "code": code}
        if code == 2:
            return {"status": "refused", "reason": message, "code": code}
        if code not in STATUS or not run:
            return {"status": "failed", "reason": message or f"exit code {code}", "code": code}
        try:
            results = Results(place / "run")
            return {"status": STATUS[code], "code": code, "reason": run.get("reason") or "",
                    "cpu_seconds": sum(run.get(phase) or 0.0 for phase in PHASES),
                    "dump": any((place / "run").glob("dump-*.hdf5")),
                    "numbers": {name: value for name, value in run.items() if type(value) in (int, float)},
                    **of_record(results.record), "bodies": of_bodies(results, job.bodies) if code == 0 else {}}  # fmt: skip
        except ResultsError as error:
            return {"status": "failed", "reason": str(error).replace(str(place / "run"), "the run"), "code": code}


def of_record(record: dict[str, np.ndarray]) -> Result:
    """Of a record: is all of it finite, how much energy was created, and least and largest value of every column."""
    if not record or not len(record["step"]):
        return {"finite": True, "created": 0.0, "ranges": {}}
    finite = all(np.isfinite(column).all() for column in record.values())
    ranges = {name: [float(np.min(column)), float(np.max(column))] for name, column in record.items() if np.isfinite(column).all()}
    return {"finite": bool(finite), "created": created(record) if finite else None, "ranges": ranges}


def created(record: dict[str, np.ndarray]) -> float:
    """Most energy that appeared between two rows and that no force or drive had brought, over the largest energy of the run.

    Potential energy counts from the origin of the deck, so that of what rests on a floor at zero is that of falling there.
    """
    own = record["kinetic_energy"] + record["potential_energy"] - sum(record[name] for name in WORKS)
    start = own[0] + sum(record[name][0] for name in LOSSES)
    own = np.concatenate([[start], own])
    scale = max(np.abs(record[name]).max() for name in ("kinetic_energy", "potential_energy", *WORKS, *LOSSES))
    gain = (own - np.minimum.accumulate(own)).max()
    return float(gain / scale) if scale > 0 else 0.0


def of_bodies(results: Results, numbers: list[int]) -> dict[str, float]:
    """Where bodies are in the last picture, and how they move."""
    if not numbers:
        return {}
    if results.bodies is None:
        raise ResultsError("no picture was taken: is this a build without HDF5?")
    grid, found = results.bodies.step(-1), {}
    for number in numbers:
        rows = np.flatnonzero(grid.point_data["id"] == number)
        if not len(rows):
            raise ResultsError(f"there is no body {number}")
        for axis, name in enumerate("xyz"):
            found[f"{name}_{number}"] = float(grid.points[rows[0], axis])
            found[f"v{name}_{number}"] = float(grid.point_data["velocity"][rows[0], axis])
        for name in ("angle", "spin"):
            if name in grid.point_data and np.ndim(grid.point_data[name][rows[0]]) == 0:
                found[f"{name}_{number}"] = float(grid.point_data[name][rows[0]])
    return found


def judge(study: VerdictStudy, job: VerdictJob, result: Result) -> Result:
    """Does a run hold? The verdict: `held`, each of its parts, and why not, in one sentence."""
    bounds, numbers = study.bounds, result.get("numbers", {})
    verdict = {"held": False, "finite": None, "unconverged": None, "energy": None, "penetration": None, "right": None, "why": ""}
    if result["code"] not in bounds.exit:
        verdict["finite"] = False if result["status"] == "not finite" else None
        return verdict | {"why": f"{result['status']}: {result['reason']}"}
    if result["status"] != "done":
        return verdict | {"held": True, "why": result["reason"]}
    steps = max(1, numbers.get("steps") or 0)
    verdict |= {"finite": result["finite"], "energy": result["created"], "unconverged": numbers["unconverged_steps"] / steps}
    if numbers.get("mean_radius"):
        verdict["penetration"] = numbers["worst_penetration"] / numbers["mean_radius"]
    faults = []
    if not verdict["finite"]:
        faults.append("a recorded value is not finite")
    if verdict["unconverged"] > bounds.unconverged:
        faults.append(f"{numbers['unconverged_steps']} of {steps} steps did not converge")
    if verdict["energy"] is not None and verdict["energy"] > bounds.energy:
        faults.append(f"energy created: {verdict['energy']:.2g} of the largest energy")
    if (verdict["penetration"] or 0) > bounds.penetration:
        faults.append(f"penetration {verdict['penetration']:.2g} of the mean radius")
    wrong, verdict["right"] = compare(study, job, result)
    return verdict | {"held": not faults and not wrong, "why": "; ".join(faults + wrong)}


def compare(study: VerdictStudy, job: VerdictJob, result: Result) -> tuple[list[str], float | None]:
    """Hold a run against what is known: sentences on what is wrong, and the largest difference over what is allowed."""
    wanted = study.expectations_of(job.case)
    if not wanted:
        return [], None
    known = study.names(job.value) | result["numbers"] | result["bodies"]
    for name, (least, largest) in result["ranges"].items():
        known |= {f"smallest_{name}": least, f"largest_{name}": largest}
    wrong, worst = [], 0.0
    for item in wanted:
        try:
            value, expected, within = (evaluate(text, known) for text in (item.value, item.expected, item.within))
        except ValueError as error:
            wrong.append(f"{item.name}: {error}")
            continue
        ratio = abs(value - expected) / within if within > 0 else 0.0 if value == expected else math.inf
        worst = max(worst, ratio if math.isfinite(ratio) else math.inf)
        if not ratio <= 1:
            wrong.append(f"{item.name} is {value:.6g}, not {expected:.6g} within {within:.2g}")
    return wrong, worst
