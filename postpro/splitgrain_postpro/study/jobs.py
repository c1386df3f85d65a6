"""The single runs of a study, each with a key by which finished ones are found: content, settings, program."""

import hashlib
import json
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from .model import Case, Study, Variant

# Raise this when what a result file holds changes its meaning.
FORMAT = 1


@dataclass
class Job:
    """One run: a case by a variant at a value of the axis. Repeat 0 is that which is traced and not timed."""

    case: Case
    variant: Variant | None
    value: float
    repeat: int
    content: str
    seconds: float
    program: str
    settings: dict = field(default_factory=dict)
    reference: str = ""

    @property
    def key(self) -> str:
        """Name of the result file: the same for the same work."""
        what = [FORMAT, self.program, self.content, self.case.dump, self.settings, self.reference, self.repeat, self.seconds]
        return hashlib.sha256(json.dumps(what, sort_keys=True).encode()).hexdigest()[:20]

    @property
    def label(self) -> str:
        """What is printed while it runs."""
        return f"{self.case.name}, {self.variant.name}, {self.value:g}" + ("" if self.repeat else ", trace")


def jobs_of(study: Study, program: str) -> list[Job]:
    """All jobs of a study, in the order in which they are best done; contents are read once a file."""
    contents = {}
    for case in study.cases:
        if case.file not in contents:
            contents[case.file] = fingerprint(case.file)
    jobs = []
    for case in study.cases:
        for variant in study.variants:
            for value in study.values:
                if variant.values and value not in variant.values:
                    continue
                if study.choice and value == min(study.values) and variant is not study.variants[0]:
                    continue  # that of the first variant is what all are measured by
                repeats = range(1, study.repeats + 1)
                if study.of_problems and value == min(study.values):
                    repeats = range(study.repeats + 1)
                # What all others are measured by may take longer.
                seconds = study.seconds * (10 if study.choice and value == min(study.values) else 1)
                for repeat in repeats:
                    jobs.append(Job(case, variant, value, repeat, contents[case.file], seconds, program,
                                    settings_of(study, case, variant, value),
                                    json.dumps(study.reference, sort_keys=True)))  # fmt: skip
        if study.choice:
            variant = finer_variant(study, case)
            jobs.append(Job(case, variant, min(study.values), 1, contents[case.file], 10 * study.choice["finer"] * study.seconds, program,
                            settings_of(study, case, variant, min(study.values))))  # fmt: skip
    return jobs


def finer_variant(study: Study, case: Case) -> Variant:
    """The first variant at a finer time step, which shows what the time step of the deck costs in accuracy."""
    first, finer = study.variants[0], study.choice["finer"]
    settings = {"time.step": step_of(case) / finer, "time.steps": case.start + finer * case.steps}
    return Variant(f"time step / {finer}", settings=first.settings | settings)


def step_of(case: Case) -> float:
    """The time step of a case."""
    if "time.step" in case.settings:
        return float(case.settings["time.step"])
    return float(tomllib.loads(case.file.read_text())["time"]["step"])


def settings_of(study: Study, case: Case, variant: Variant, value: float) -> dict:
    """Settings of a run in addition to its file."""
    if study.of_problems:
        return {"solver": variant.solver, "guess": variant.guess, "iterations": variant.iterations, "tolerance": value,
                "deck": case.settings}  # fmt: skip
    settings = {**case.settings, **({"time.steps": case.start + case.steps} if case.steps else {}), **case.then,
                **variant.settings}
    if study.axis == "tolerances":
        settings["solver.tolerance"] = value
    if study.axis == "time_steps":
        steps = round(study.duration / value)
        settings |= {"time.step": value, "time.steps": steps}
        every = max(1, steps // 100)
        if any(measure.column and measure.over != "end" for measure in study.measures):
            settings.setdefault("output.record_every", every)
        if any(measure.body or measure.bodies for measure in study.measures):
            settings.setdefault("output.every", steps if _at_the_end(study) else every)
    elif any(measure.bodies for measure in study.measures):
        # The end is drawn in any case.
        settings["output.every"] = 1000000000
    if any(measure.below for measure in study.measures) or case.start:
        settings["output.record_every"] = 1
    if case.start:
        settings["start"] = [case.start, case.settings]
    parts = int(value) if study.axis == "subdomains" else variant.parts
    if parts > 1:
        settings["partition.parts"] = parts
    settings["measures"] = [vars(measure) | {"name": "", "unit": "", "closed_form": "", "against": ""} for measure in study.measures]
    return settings


def _at_the_end(study):
    """Are places of bodies asked for at the end alone?"""
    return all(measure.over == "end" for measure in study.measures if measure.body)


def fingerprint(path: Path) -> str:
    """Hash of a file, and of the files and folders that it names when it is a deck."""
    digest = hashlib.sha256()
    if path.is_dir():
        for file in sorted(path.rglob("*")):
            if file.is_file():
                digest.update(str(file.relative_to(path)).encode() + file.read_bytes())
        return digest.hexdigest()
    content = path.read_bytes()
    digest.update(content)
    if path.suffix == ".toml":
        try:
            table = tomllib.loads(content.decode())
        except ValueError:
            return digest.hexdigest()  # the program will report what is wrong
        for name in sorted(set(_texts(table))):
            other = path.parent / name
            if name and len(name) < 200 and other != path and other.exists() and other.resolve() != path.parent.resolve():
                digest.update(fingerprint(other).encode())
    return digest.hexdigest()


def _texts(value):
    """All texts in a table."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for item in value.values() if isinstance(value, dict) else value:
            yield from _texts(item)
