"""The single runs of a study, each with a key that tells whether it has been done: content, settings, program."""

import hashlib
import json
import tomllib
from dataclasses import dataclass, field

from .model import Case, Variant

# Raise this when what a result file holds changes its meaning.
FORMAT = 1


@dataclass
class Job:
    """One run: a case by a variant at a value of the axis. Repeat 0 is that which is traced and not timed."""

    case: Case
    variant: Variant
    value: float
    repeat: int
    content: str
    seconds: float
    program: str
    settings: dict = field(default_factory=dict)
    reference: str = ""

    @property
    def key(self):
        """Name of the result file: the same for the same work."""
        what = [FORMAT, self.program, self.content, self.case.dump, self.settings, self.reference, self.repeat, self.seconds]
        return hashlib.sha256(json.dumps(what, sort_keys=True).encode()).hexdigest()[:20]

    @property
    def label(self):
        """What is said while it runs."""
        return f"{self.case.name}, {self.variant.name}, {self.value:g}" + ("" if self.repeat else ", trace")


def jobs_of(study, program):
    """All jobs of a study, in the order in which they are best done; contents are read once a file."""
    contents = {}
    for case in study.cases:
        if case.file not in contents:
            contents[case.file] = fingerprint(case.file)
    jobs = []
    for case in study.cases:
        for variant in study.variants:
            for value in study.values:
                repeats = range(1, study.repeats + 1)
                if study.of_problems and value == min(study.values):
                    repeats = range(study.repeats + 1)
                for repeat in repeats:
                    jobs.append(Job(case, variant, value, repeat, contents[case.file], study.seconds, program,
                                    settings_of(study, case, variant, value),
                                    json.dumps(study.reference, sort_keys=True)))  # fmt: skip
    return jobs


def settings_of(study, case, variant, value):
    """What a run is told beside its file."""
    if study.of_problems:
        return {"solver": variant.solver, "guess": variant.guess, "iterations": variant.iterations, "tolerance": value,
                "deck": case.settings}  # fmt: skip
    settings = {**case.settings, **variant.settings}
    if study.axis == "tolerances":
        settings["solver.tolerance"] = value
    if study.axis == "time_steps":
        steps = round(study.duration / value)
        settings |= {"time.step": value, "time.steps": steps}
        every = max(1, steps // 100)
        if any(measure.column and measure.over != "end" for measure in study.measures):
            settings.setdefault("output.record_every", every)
        if any(measure.body for measure in study.measures):
            settings.setdefault("output.every", steps if _at_the_end(study) else every)
    settings["ranks"] = int(value) if study.axis == "subdomains" else 1
    settings["measures"] = [vars(measure) | {"name": "", "unit": "", "closed_form": ""} for measure in study.measures]
    return settings


def _at_the_end(study):
    """Is it enough to know where bodies are at the end?"""
    return all(measure.over == "end" for measure in study.measures if measure.body)


def fingerprint(path):
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
            return digest.hexdigest()  # the program will say what is wrong
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
