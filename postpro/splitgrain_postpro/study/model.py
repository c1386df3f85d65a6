"""A study as numbers and names: what it varies, its cases, variants and measures."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

# What a run gave, by name; the results of all runs, by case, variant and value.
Result = dict[str, Any]
Table = dict[tuple[str, str, float], Result]
# Points of a diagram, by variant; and a section of the page: heading, is it open (None: it does not fold), content in HTML.
Curves = dict[str, list[tuple]]
Section = tuple[str, bool | None, str]
# The default of `splitgrain solve`.
DEFAULT_SOLVER = "auto"
# The lists that a study can vary, and the name of one value of each.
AXES = {"tolerances": "tolerance", "time_steps": "time step", "subdomains": "subdomain"}

# What a history within a step holds per point: columns of trace.csv.
HISTORY = ("iteration", "cpu_seconds", "e8", "messages", "bytes", "collectives")


@dataclass
class Case:
    """A deck, or the file of a contact problem: there already, or dumped at a step of the deck."""

    name: str
    file: Path
    dump: int = 0
    settings: dict = field(default_factory=dict)
    # Steps of the deck that are done before, once, for all variants; and steps that each of them goes on.
    start: int = 0
    steps: int = 0
    kind: str = ""
    # Settings of the runs that go on alone, not of the state that they go on from.
    then: dict = field(default_factory=dict)


@dataclass
class Variant:
    """A solver of contact problems with its options, or settings of a run."""

    name: str
    solver: str = DEFAULT_SOLVER
    guess: bool = False
    iterations: int = 0
    settings: dict = field(default_factory=dict)
    parts: int = 1
    # Values of the axis that it is run at; all where there are none.
    values: list = field(default_factory=list)


@dataclass
class Measure:
    """A number of a run that has an error: a column of the record, the time from which it stays below a limit, where a body is, or
    where all bodies are and how fast."""

    name: str
    column: str = ""
    body: int = 0
    bodies: str = ""
    below: float = 0.0
    component: str = "x"
    closed_form: str = ""
    over: str = "end"
    against: str = "own"
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
    choice: dict = field(default_factory=dict)
