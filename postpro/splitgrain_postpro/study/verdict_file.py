"""Files of studies that give verdicts: cases by variants over the values of a parameter, bounds, and answers that are known."""

import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from .blocks import cases_of, variant_of
from .expressions import evaluate
from .model import Case, Variant
from .study_file import StudyFile

# Key: kinds allowed.
TOP = {
    "title": (str,), "about": (str,), "seconds": (int, float), "jobs": (int, str), "constants": (dict,), "case": (list,),
    "variant": (list,), "expect": (list,), "parameter": (dict,), "threshold": (dict,), "verdict": (dict,),
}  # fmt: skip
PARAMETER = {"name": (str,), "unit": (str,), "values": (list,), "scale": (str,)}
THRESHOLD = {"until": (int, float)}
VERDICT = {"unconverged": (int, float), "energy": (int, float), "penetration": (int, float), "exit": (list,)}
EXPECT = {"name": (str,), "value": (str,), "is": (str, int, float), "within": (str, int, float), "cases": (list,)}
SETTING = re.compile(r"\{([^{}]*)\}")
# x_3 is where body 3 is at the end, vx_3 its velocity; of planar scenes also angle_3 and spin_3.
OF_BODY = re.compile(r"\b(v?[xyz]|angle|spin)_(\d+)\b")


@dataclass
class Bounds:
    """What a run may do and still hold."""

    unconverged: float = 0.0
    """Largest share of steps that do not converge"""
    energy: float = 1e-6
    """Most energy that may be created, over the largest energy of the run"""
    penetration: float = 1e-3
    """Deepest penetration of all steps over the mean radius of the grains"""
    exit: list = field(default_factory=lambda: [0])
    """Exit codes that are right"""


@dataclass
class Expectation:
    """A number of a run that is known."""

    name: str
    value: str
    expected: str
    within: str
    cases: list


@dataclass
class VerdictStudy:
    """A whole study that gives verdicts."""

    path: Path
    title: str
    about: str
    seconds: float
    jobs: int | str
    constants: dict
    parameter: str
    unit: str
    values: list
    is_log: bool
    until: float | None
    bounds: Bounds
    cases: list
    variants: list
    expectations: list
    of_problems: bool = False

    def names(self, value: float | None) -> dict[str, float]:
        """Constants at a value of the parameter, which is p."""
        known = {} if value is None else {"p": value}
        for name, text in self.constants.items():
            known[name] = evaluate(text, known)
        return known

    def settings(self, case: Case, variant: Variant, value: float | None) -> dict:
        """Settings of a run: what stands in braces is worked out."""
        known = self.names(value)
        return {name: filled(text, known) for name, text in {**case.settings, **variant.settings}.items()}

    def expectations_of(self, case: Case) -> list[Expectation]:
        """What is known of a case."""
        return [item for item in self.expectations if not item.cases or case.name in item.cases]

    def bodies(self, case: Case) -> list[int]:
        """Numbers of bodies whose place or velocity at the end is asked for."""
        texts = " ".join(f"{item.value} {item.expected} {item.within}" for item in self.expectations_of(case))
        return sorted({int(match[2]) for match in OF_BODY.finditer(texts)})


def filled(text: object, known: dict[str, float]) -> object:
    """A setting with what stands in braces worked out."""
    if not isinstance(text, str):
        return text
    return SETTING.sub(lambda match: f"{evaluate(match[1], known):.17g}", text)


class VerdictReader(StudyFile):
    """Reads one study file that gives verdicts."""

    def study(self) -> VerdictStudy:
        """The study."""
        table = self.table
        self.check(table, TOP)
        for name in ("case", "variant"):
            if not table.get(name):
                self.fail(f"a study needs at least one [[{name}]]")
        cases = [case for number, block in enumerate(table["case"], 1) for case in cases_of(self, block, number)]
        if any(case.dump >= 0 for case in cases):
            self.fail("verdicts are given on runs of decks, not on contact problems", "case")
        jobs = table.get("jobs", 1)
        if jobs != "all" and (isinstance(jobs, str) or jobs < 1):
            self.fail("'jobs' should be a whole number above 0, or \"all\"", key="jobs")
        name, unit, values, is_log = self.parameter()
        study = VerdictStudy(
            self.path, table.get("title", self.path.stem), table.get("about", ""), float(self.positive("seconds", 60)),
            jobs, table.get("constants", {}), name, unit, values, is_log, self.until(), self.bounds(), cases,
            [variant_of(self, block, number, False) for number, block in enumerate(table["variant"], 1)],
            [self.expectation(block, number, cases) for number, block in enumerate(table.get("expect", []), 1)],
        )  # fmt: skip
        self.check_whole(study)
        return study

    def parameter(self) -> tuple[str, str, list, bool]:
        """Name, unit, values in rising order, and whether its scale is logarithmic; one value that is none where it is not there."""
        block = self.table.get("parameter")
        if block is None:
            return "", "", [None], False
        self.check(block, PARAMETER, "parameter")
        values = block.get("values", [])
        if not values or any(type(value) not in (int, float) or not abs(value) < 1e300 for value in values):
            self.fail("'values' of [parameter] should be a list of numbers", "parameter", 1, "values")
        if block.get("scale", "log") not in ("log", "linear"):
            self.fail("'scale' of [parameter] should be log or linear", "parameter", 1, "scale")
        return block.get("name", "p"), block.get("unit", "-"), sorted(set(values)), block.get("scale", "log") == "log"

    def until(self) -> float | None:
        """How far thresholds are bisected; None where none is asked for."""
        block = self.table.get("threshold")
        if block is None:
            return None
        self.check(block, THRESHOLD, "threshold")
        if not block.get("until", 0.1) > 0:
            self.fail("'until' of [threshold] should be above 0", "threshold", 1, "until")
        return float(block.get("until", 0.1))

    def bounds(self) -> Bounds:
        """The bounds."""
        block = self.table.get("verdict", {})
        self.check(block, VERDICT, "verdict")
        return Bounds(**block)

    def expectation(self, block: dict, number: int, cases: list[Case]) -> Expectation:
        """What is known of some cases."""
        self.table_of(block, EXPECT, "expect", number)
        for key in ("value", "is", "within"):
            if key not in block:
                self.fail(f"[[expect]] needs '{key}'", "expect", number)
        for name in block.get("cases", []):
            if name not in [case.name for case in cases]:
                self.fail(f"there is no case '{name}'", "expect", number, "cases")
        return Expectation(block.get("name", block["value"]), block["value"], str(block["is"]), str(block["within"]),
                           block.get("cases", []))  # fmt: skip

    def check_whole(self, study: VerdictStudy) -> None:
        """What only shows when all is known: names, and that what stands in braces has a value."""
        for name, items in (("case", study.cases), ("variant", study.variants)):
            names = [item.name for item in items]
            for number, other in enumerate(names):
                if other in names[:number]:
                    self.fail(f"two of [[{name}]] are named '{other}'", name, number + 1, "name")
        for value in study.values:
            try:
                study.names(value)
            except ValueError as error:
                self.fail(str(error), "constants")
            for number, case in enumerate(study.cases, 1):
                for variant in study.variants:
                    try:
                        study.settings(case, variant, value)
                    except ValueError as error:
                        self.fail(str(error), "case", number, "set")
        if study.until and study.is_log and any(value <= 0 for value in study.values) and len(study.values) < 2:
            self.fail("a threshold needs two values or more", "parameter", 1, "values")


def gives_verdicts(table: dict) -> bool:
    """Is a study file one that gives verdicts?"""
    return any(name in table for name in ("verdict", "parameter", "threshold", "expect"))


def middle(low: float, high: float, is_log: bool) -> float:
    """The value between two of a parameter: geometric on a logarithmic scale, where both are above zero."""
    return math.sqrt(low * high) if is_log and low > 0 else (low + high) / 2


def distance(low: float, high: float, is_log: bool) -> float:
    """How far two values are apart: in decades on a logarithmic scale, where both are above zero."""
    return math.log10(high / low) if is_log and low > 0 else high - low
