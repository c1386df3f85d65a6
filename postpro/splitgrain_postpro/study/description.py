"""What a study file holds, checked: every mistake is one sentence with its line."""

from pathlib import Path

from .blocks import cases_of, measure_of, variant_of
from .expressions import evaluate
from .model import AXES, DEFAULT_SOLVER, Study
from .study_file import StudyFile

# Key: kinds allowed. A list is of numbers, a table of settings.
TOP = {
    "title": (str,), "about": (str,), "repeats": (int,), "seconds": (int, float), "jobs": (int, str),
    "duration": (int, float), "constants": (dict,), "case": (list,), "variant": (list,), "measure": (list,),
    "reference": (dict,), "choice": (dict,), "tolerances": (list,), "time_steps": (list,), "subdomains": (list,),
}  # fmt: skip
REFERENCE = {"solver": (str,), "tolerance": (int, float)}
# What a choice is made by, and the default of each (choice).
CHOICE = {"measure": (str,), "finer": (int,), "share": (int, float), "least": (int, float), "cases": (int, float),
          "worst": (int, float), "present": (list,)}  # fmt: skip


class Reader(StudyFile):
    """Reads one study file."""

    def study(self) -> Study:
        """The study."""
        table = self.table
        self.check(table, TOP)
        axis, values = self.axis()
        for name in ("case", "variant"):
            if not table.get(name):
                self.fail(f"a study needs at least one [[{name}]]")
        cases = [case for number, block in enumerate(table["case"], 1) for case in cases_of(self, block, number)]
        dumps = {case.dump >= 0 for case in cases}
        if len(dumps) > 1:
            self.fail("a study is of contact problems (files, or a deck with dump) or of runs (deck alone), not of both", "case")
        of_problems = dumps == {True}
        if of_problems and axis != "tolerances":
            self.fail(f"contact problems are solved at several tolerances, not {AXES[axis]}s", key=axis)
        study = Study(
            self.path, table.get("title", self.path.stem), table.get("about", ""), axis, values, cases,
            [variant_of(self, block, number, of_problems, values) for number, block in enumerate(table["variant"], 1)], [],
            self.constants(), float(self.positive("duration", 0)), int(self.positive("repeats", 1)),
            float(self.positive("seconds", 60)), table.get("jobs", 1), self.reference(), of_problems,
        )  # fmt: skip
        study.measures = [measure_of(self, block, number, study) for number, block in enumerate(table.get("measure", []), 1)]
        study.choice = self.choice(study)
        self.check_whole(study)
        return study

    def axis(self) -> tuple[str, list[float]]:
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

    def constants(self) -> dict[str, float]:
        """Constants, each an expression of those before it."""
        known = {}
        for name, text in self.table.get("constants", {}).items():
            try:
                known[name] = evaluate(text, known)
            except ValueError as error:
                self.fail(str(error), "constants", 1, name)
        return known

    def reference(self) -> dict:
        """Solver and tolerance of reference solutions."""
        block = self.table.get("reference", {})
        self.check(block, REFERENCE, "reference")
        if not 0 < block.get("tolerance", 1) < 1e300:
            self.fail("'tolerance' of [reference] should be above 0", "reference", 1, "tolerance")
        return {"solver": DEFAULT_SOLVER, "tolerance": 1e-12} | block if block else {}

    def choice(self, study: Study) -> dict:
        """What a choice among variants and tolerances is made by; empty without one."""
        if "choice" not in self.table:
            return {}
        block = self.table["choice"]
        self.check(block, CHOICE, "choice")
        if study.of_problems or study.axis != "tolerances" or not study.measures:
            self.fail("a choice is made among runs at several tolerances, by a measure", "choice")
        for key, value in block.items():
            if isinstance(value, int | float) and not 0 < value < 1e300:
                self.fail(f"'{key}' of [choice] should be above 0", "choice", 1, key)
        names = [measure.name for measure in study.measures]
        if block.get("measure", names[0]) not in names:
            self.fail(f"there is no measure '{block['measure']}'", "choice", 1, "measure")
        present = block.get("present", [])
        if present and (len(present) != 2 or present[0] not in [v.name for v in study.variants] or present[1] not in study.values):
            self.fail("'present' of [choice] should be the name of a variant and a tolerance", "choice", 1, "present")
        return {"measure": names[0], "finer": 4, "share": 0.3, "least": 1e-4, "cases": 0.9, "worst": 10.0, "present": []} | block

    def check_whole(self, study: Study) -> None:
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


def read_study(path: Path) -> Study:
    """Read and check a study file."""
    return Reader(path).study()
