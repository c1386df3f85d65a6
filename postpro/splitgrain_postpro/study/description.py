"""What a study file says, checked: every mistake is one sentence with its line."""

import difflib
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import StudyError
from .expressions import evaluate
from .toml_lines import line_of

AXES = {"tolerances": "tolerance", "time_steps": "time step", "subdomains": "subdomains"}
# Key: kinds allowed. A list is of numbers, a table of settings.
TOP = {
    "title": (str,), "about": (str,), "repeats": (int,), "seconds": (int, float), "jobs": (int, str),
    "duration": (int, float), "constants": (dict,), "case": (list,), "variant": (list,), "measure": (list,),
    "reference": (dict,), "tolerances": (list,), "time_steps": (list,), "subdomains": (list,),
}  # fmt: skip
CASE = {"name": (str,), "files": (str, list), "deck": (str,), "dump": (int, list), "set": (dict,)}
VARIANT = {"name": (str,), "solver": (str,), "guess": (bool,), "iterations": (int,), "set": (dict,)}
MEASURE = {"name": (str,), "column": (str,), "body": (int,), "component": (str,), "closed_form": (str, int, float),
           "over": (str,), "unit": (str,)}  # fmt: skip
REFERENCE = {"solver": (str,), "tolerance": (int, float)}
OVER = ("end", "mean", "largest")


@dataclass
class Case:
    """A deck, or the file of a contact problem: there already, or dumped at a step of the deck."""

    name: str
    file: Path
    dump: int = 0
    settings: dict = field(default_factory=dict)


@dataclass
class Variant:
    """A solver of contact problems with its options, or settings of a run."""

    name: str
    solver: str = "auto"
    guess: bool = False
    iterations: int = 0
    settings: dict = field(default_factory=dict)


@dataclass
class Measure:
    """A number of a run that has an error: a column of the record, or where a body is."""

    name: str
    column: str = ""
    body: int = 0
    component: str = "x"
    closed_form: str = ""
    over: str = "end"
    unit: str = ""


@dataclass
class Study:
    """A whole study."""

    path: Path
    title: str
    about: str
    axis: str
    values: list
    cases: list
    variants: list
    measures: list
    constants: dict
    duration: float
    repeats: int
    seconds: float
    jobs: int | str
    reference: dict
    of_problems: bool


class Reader:
    """Reads one study file."""

    def __init__(self, path):
        self.path = Path(path)
        try:
            self.text = self.path.read_text()
            self.table = tomllib.loads(self.text)
        except tomllib.TOMLDecodeError as error:
            sentence, _, place = str(error).partition(" (at ")
            line = int(place.split()[1].strip(",")) if place.startswith("line") else len(self.text.splitlines())
            raise StudyError(sentence[0].lower() + sentence[1:], self.path, line) from error
        except OSError as error:
            raise StudyError(f"cannot read the study: {error.strerror}", self.path) from error
        except UnicodeDecodeError as error:
            raise StudyError("the study is no text in UTF-8", self.path) from error

    def fail(self, sentence, section="", number=1, key=""):
        """Say what is wrong, and where."""
        line = line_of(self.text, section, number, key)
        # At the top a key may be the head of a section.
        raise StudyError(sentence, self.path, line_of(self.text, key) if line == 1 and key and not section else line)

    def check(self, table, known, section="", number=1):
        """Are all keys known and of their kind?"""
        where = f" of [{section}]" if section else ""
        for key, value in table.items():
            if key not in known:
                near = difflib.get_close_matches(key, known, 1)
                hint = f"; did you mean '{near[0]}'?" if near else f"; there are {', '.join(known)}"
                self.fail(f"unknown key '{key}'{where}{hint}", section, number, key)
            kinds = known[key]
            if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
                names = {str: "a text", int: "a whole number", float: "a number", bool: "true or false",
                         list: "a list", dict: "a table"}  # fmt: skip
                self.fail(f"'{key}'{where} should be {' or '.join(names[kind] for kind in kinds)}", section, number, key)

    def study(self):
        """The study."""
        table = self.table
        self.check(table, TOP)
        axis, values = self.axis()
        for name in ("case", "variant"):
            if not table.get(name):
                self.fail(f"a study needs at least one [[{name}]]")
        cases = [case for number, block in enumerate(table["case"], 1) for case in self.cases(block, number)]
        dumps = {case.dump >= 0 for case in cases}
        if len(dumps) > 1:
            self.fail("a study is of contact problems (files, or a deck with dump) or of runs (deck alone), not of both", "case")
        of_problems = dumps == {True}
        if of_problems and axis != "tolerances":
            self.fail(f"contact problems are solved at several tolerances, not {AXES[axis]}s", key=axis)
        study = Study(
            self.path, table.get("title", self.path.stem), table.get("about", ""), axis, values, cases,
            [self.variant(block, number, of_problems) for number, block in enumerate(table["variant"], 1)], [],
            self.constants(), float(self.positive("duration", 0)), int(self.positive("repeats", 1)),
            float(self.positive("seconds", 60)), table.get("jobs", 1), self.reference(), of_problems,
        )  # fmt: skip
        study.measures = [self.measure(block, number, study) for number, block in enumerate(table.get("measure", []), 1)]
        self.check_whole(study)
        return study

    def axis(self):
        """What is varied: the one list of numbers that is there."""
        given = [name for name in AXES if name in self.table]
        if len(given) != 1:
            self.fail(f"a study needs one of {', '.join(AXES)}" + (f", not {' and '.join(given)}" if given else ""),
                      key=given[-1] if given else "")
        values = self.table[given[0]]
        whole = given[0] == "subdomains"
        if not values or any(isinstance(v, bool) or not isinstance(v, int if whole else (int, float)) or not 0 < v < 1e300
                             for v in values):
            self.fail(f"'{given[0]}' should be a list of {'whole ' if whole else ''}numbers above 0", key=given[0])
        return given[0], sorted(set(values), reverse=not whole)

    def positive(self, key, default):
        """A number above 0."""
        value = self.table.get(key, default)
        if key in self.table and not 0 < value < 1e300:
            self.fail(f"'{key}' should be above 0", key=key)
        return value

    def constants(self):
        """Constants, each an expression of those before it."""
        known = {}
        for name, text in self.table.get("constants", {}).items():
            try:
                known[name] = evaluate(text, known)
            except ValueError as error:
                self.fail(str(error), "constants", 1, name)
        return known

    def cases(self, block, number):
        """The cases of a block: one for each file, or for each step that is dumped."""
        self.table_of(block, CASE, "case", number)
        if ("files" in block) == ("deck" in block):
            self.fail("a case needs either a deck or files of contact problems", "case", number, "files")
        if "files" in block:
            return self.files(block, number)
        deck = self.path.parent / block["deck"]
        if not deck.exists():
            self.fail(f"there is no deck {deck}", "case", number, "deck")
        name = block.get("name", deck.stem)
        if "dump" not in block:
            return [Case(name, deck, -1, block.get("set", {}))]
        steps = block["dump"] if isinstance(block["dump"], list) else [block["dump"]]
        if not steps or any(type(step) is not int or step < 1 for step in steps):
            self.fail("'dump' of [case] should be a time step or a list of them, from 1", "case", number, "dump")
        return [Case(name if len(steps) == 1 else f"{name}, step {step}", deck, step, block.get("set", {})) for step in steps]

    def files(self, block, number):
        """A case for every file that the patterns find."""
        patterns = block["files"] if isinstance(block["files"], list) else [block["files"]]
        for key in ("dump", "set"):
            if key in block:
                self.fail(f"'{key}' belongs to cases with a deck", "case", number, key)
        found = []
        for pattern in map(str, patterns):
            folder = self.path.parent if not Path(pattern).is_absolute() else Path("/")
            matches = sorted(folder.glob(str(Path(pattern).relative_to(folder)) if folder == Path("/") else pattern))
            if not matches:
                self.fail(f"no file is named {pattern}, seen from the folder of the study: the contact problems that it needs "
                          "are not there", "case", number, "files")  # fmt: skip
            found += matches
        name = block.get("name", "")
        return [Case(name if name and len(found) == 1 else f"{name} {file.stem}".strip(), file) for file in found]

    def variant(self, block, number, of_problems):
        """One variant."""
        self.table_of(block, VARIANT, "variant", number)
        for key in ("set",) if of_problems else ("solver", "guess", "iterations"):
            if key in block:
                kind = "runs" if of_problems else "contact problems"
                self.fail(f"'{key}' belongs to variants of {kind}", "variant", number, key)
        name = block.get("name", block.get("solver"))
        if not name:
            self.fail("a variant needs a name", "variant", number)
        return Variant(name, block.get("solver", "auto"), block.get("guess", False), block.get("iterations", 0),
                       block.get("set", {}))  # fmt: skip

    def measure(self, block, number, study):
        """One measure."""
        self.table_of(block, MEASURE, "measure", number)
        if study.of_problems:
            self.fail("measures belong to runs; contact problems have their errors", "measure", number)
        if ("column" in block) == ("body" in block):
            self.fail("a measure needs either a column of record.csv or a body", "measure", number)
        if block.get("over", "end") not in OVER:
            self.fail(f"'over' of [measure] should be {', '.join(OVER)}", "measure", number, "over")
        if block.get("component", "x") not in ("x", "y", "z"):
            self.fail("'component' of [measure] should be x, y or z", "measure", number, "component")
        if "closed_form" in block:
            try:
                evaluate(block["closed_form"], study.constants | {"t": study.duration or 1.0})
            except ValueError as error:
                self.fail(str(error), "measure", number, "closed_form")
        default = block.get("column", f"{block.get('component', 'x')} of body {block.get('body')}")
        return Measure(**({"name": default} | block | {"closed_form": str(block.get("closed_form", ""))}))

    def reference(self):
        """Solver and tolerance of reference solutions."""
        block = self.table.get("reference", {})
        self.check(block, REFERENCE, "reference")
        if not 0 < block.get("tolerance", 1) < 1e300:
            self.fail("'tolerance' of [reference] should be above 0", "reference", 1, "tolerance")
        return {"solver": "auto", "tolerance": 1e-12} | block if block else {}

    def table_of(self, block, known, section, number):
        """Is a block a table with known keys, and are its settings single values?"""
        if not isinstance(block, dict):
            self.fail(f"'{section}' should be written as [[{section}]]", key=section)
        self.check(block, known, section, number)
        for key, value in block.get("set", {}).items():
            if isinstance(value, dict):
                self.fail(f"a setting is written \"section.key\" = value, with quotes, not as the table '{key}'",
                          section, number, "set")  # fmt: skip

    def check_whole(self, study):
        """What only shows when all is known."""
        jobs = study.jobs
        if jobs != "all" and (isinstance(jobs, str) or jobs < 1):
            self.fail("'jobs' should be a whole number above 0, or \"all\"", key="jobs")
        for name, items in (("case", study.cases), ("variant", study.variants), ("measure", study.measures)):
            names = [item.name for item in items]
            for number, other in enumerate(names):
                if other in names[:number]:
                    self.fail(f"two of [[{name}]] are named '{other}'", name, number + 1, "name")
        if study.axis == "time_steps":
            if not study.duration:
                self.fail("a study of time steps needs its 'duration' [s]", key="time_steps")
            for step in study.values:
                if abs(study.duration / step - round(study.duration / step)) > 1e-6:
                    self.fail(f"the duration {study.duration:g} s is no whole number of time steps {step:g} s", key="time_steps")


def read_study(path):
    """Read and check a study file."""
    return Reader(path).study()
