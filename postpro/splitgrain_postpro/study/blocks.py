"""The blocks of a study file: [[case]], [[variant]], [[measure]]."""

from collections.abc import Sequence
from pathlib import Path

from .expressions import evaluate
from .model import DEFAULT_SOLVER, Case, Measure, Study, Variant
from .study_file import StudyFile

# Key: kinds allowed. A list is of numbers, a table of settings.
CASE = {"name": (str,), "files": (str, list), "deck": (str,), "dump": (int, list), "set": (dict,), "from": (int,), "steps": (int,),
        "then": (dict,), "kind": (str,)}  # fmt: skip
VARIANT = {"name": (str,), "solver": (str,), "guess": (bool,), "iterations": (int,), "set": (dict,), "values": (list,), "parts": (int,)}  # fmt: skip
MEASURE = {"name": (str,), "column": (str,), "below": (int, float), "body": (int,), "component": (str,), "bodies": (str,),
           "closed_form": (str, int, float), "over": (str,), "unit": (str,), "against": (str,)}  # fmt: skip
OVER = ("end", "mean", "largest")


def cases_of(file: StudyFile, block: dict, number: int) -> list[Case]:
    """The cases of a block: one for each file, or for each step that is dumped."""
    file.table_of(block, CASE, "case", number)
    if ("files" in block) == ("deck" in block):
        file.fail("a case needs either a deck or files of contact problems", "case", number, "files")
    if "files" in block:
        return cases_of_files(file, block, number)
    deck = file.path.parent / block["deck"]
    if not deck.exists():
        file.fail(f"there is no deck {deck}", "case", number, "deck")
    name, kind = block.get("name", deck.stem), block.get("kind", "")
    if "dump" not in block:
        start, steps = block.get("from", 0), block.get("steps", 0)
        if start < 0 or steps < 0 or (start and not steps):
            file.fail("'from' of [case] is a time step, from which every variant goes on by so many 'steps'", "case", number, "from")
        if "then" in block and not start:
            file.fail("'then' of [case] holds settings of runs that go on 'from' a time step", "case", number, "then")
        return [Case(name, deck, -1, block.get("set", {}), start, steps, kind, block.get("then", {}))]
    steps = block["dump"] if isinstance(block["dump"], list) else [block["dump"]]
    if not steps or any(type(step) is not int or step < 1 for step in steps):
        file.fail("'dump' of [case] should be a time step or a list of them, from 1", "case", number, "dump")
    return [Case(name if len(steps) == 1 else f"{name}, step {step}", deck, step, block.get("set", {}), kind=kind) for step in steps]


def cases_of_files(file: StudyFile, block: dict, number: int) -> list[Case]:
    """A case for every file that the patterns find."""
    patterns = block["files"] if isinstance(block["files"], list) else [block["files"]]
    for key in ("dump", "set", "from", "steps", "then"):
        if key in block:
            file.fail(f"'{key}' belongs to cases with a deck", "case", number, key)
    found = []
    for pattern in map(str, patterns):
        folder = file.path.parent if not Path(pattern).is_absolute() else Path("/")
        matches = sorted(folder.glob(str(Path(pattern).relative_to(folder)) if folder == Path("/") else pattern))
        if not matches:
            file.fail(f"no file is named {pattern}, seen from the folder of the study: the contact problems that it needs "
                      "are not there", "case", number, "files")  # fmt: skip
        found += matches
    name = block.get("name", "")
    kind = block.get("kind", "")
    return [Case(name if name and len(found) == 1 else f"{name} {path.stem}".strip(), path, kind=kind) for path in found]


def variant_of(file: StudyFile, block: dict, number: int, of_problems: bool, values: Sequence[float] = ()) -> Variant:
    """One variant; `values` are those of the axis."""
    file.table_of(block, VARIANT, "variant", number)
    for key in ("set", "parts") if of_problems else ("solver", "guess", "iterations"):
        if key in block:
            kind = "runs" if of_problems else "contact problems"
            file.fail(f"'{key}' belongs to variants of {kind}", "variant", number, key)
    name = block.get("name", block.get("solver"))
    if not name:
        file.fail("a variant needs a name", "variant", number)
    if not set(block.get("values", [])) <= set(values):
        file.fail("'values' of [variant] should be some of those that are varied", "variant", number, "values")
    if block.get("parts", 1) < 1:
        file.fail("'parts' of [variant] should be above 0", "variant", number, "parts")
    return Variant(name, block.get("solver", DEFAULT_SOLVER), block.get("guess", False), block.get("iterations", 0),
                   block.get("set", {}), block.get("parts", 1), block.get("values", []))  # fmt: skip


def measure_of(file: StudyFile, block: dict, number: int, study: Study) -> Measure:
    """One measure."""
    file.table_of(block, MEASURE, "measure", number)
    if study.of_problems:
        file.fail("measures belong to runs; contact problems have their errors", "measure", number)
    if sum(key in block for key in ("column", "body", "bodies")) != 1:
        file.fail("a measure needs either a column of record.csv, or a body, or bodies", "measure", number)
    if block.get("bodies", "position") not in ("position", "velocity"):
        file.fail("'bodies' of [measure] should be position or velocity", "measure", number, "bodies")
    if block.get("against", "own") not in ("own", "first"):
        file.fail("'against' of [measure] should be own or first", "measure", number, "against")
    if "below" in block and "column" not in block:
        file.fail("'below' of [measure] needs a column", "measure", number, "below")
    for key in ("over", "closed_form"):
        if key in block and ("bodies" in block or (key == "over" and "below" in block)):
            file.fail(f"'{key}' is not for measures of all bodies, or of times", "measure", number, key)
    if block.get("over", "end") not in OVER:
        file.fail(f"'over' of [measure] should be {', '.join(OVER)}", "measure", number, "over")
    if block.get("component", "x") not in ("x", "y", "z"):
        file.fail("'component' of [measure] should be x, y or z", "measure", number, "component")
    if "closed_form" in block:
        try:
            evaluate(block["closed_form"], study.constants | {"t": study.duration or 1.0})
        except ValueError as error:
            file.fail(str(error), "measure", number, "closed_form")
    default = block.get("column", f"{block.get('component', 'x')} of body {block.get('body')}")
    if "bodies" in block:
        default = f"{block['bodies']} of bodies"
    return Measure(**({"name": default} | block | {"closed_form": str(block.get("closed_form", ""))}))
