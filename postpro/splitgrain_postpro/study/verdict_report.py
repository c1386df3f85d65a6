"""From verdicts to CSV, figures, lines and the page."""

from collections.abc import Iterator

from matplotlib.figure import Figure

from ..style import as_png, styled
from . import page, verdict_drawings
from .csv_text import csv_text
from .deck_titles import deck_section
from .model import Result
from .runner import Store
from .svg import embedded
from .thresholds import changes_of, sentence
from .verdict_file import VerdictStudy
from .verdicts import Point, Verdicts

COLUMNS = ("case", "variant", "value", "held", "status", "exit", "finite", "unconverged", "energy", "penetration", "right",
           "steps", "sweeps", "worst_e1", "worst_e8", "cpu_seconds", "why")  # fmt: skip
LEGEND = (
    "A run holds when it ends as it should (exit code), with finite values, no more steps unconverged than the study allows, "
    "no energy that no force or drive has brought (over the largest energy of the run), penetrations within the bound (over the mean "
    "radius of the grains), and the answers that are known. In the column 'right' stands the largest difference from these over what "
    "is allowed: 1 and below is right."
)


class VerdictReport:
    """All that is made of verdicts: `table` has the points (job, result, verdict) of each (case, variant)."""

    def __init__(self, study: VerdictStudy, table: Verdicts, store: Store, version: str):
        self.study, self.table, self.store, self.version, self.figures = study, table, store, version, 0

    def write(self) -> list[str]:
        """Write everything; returns the lines to print."""
        rows = [row_of(point) for points in self.table.values() for point in points]
        self.write_csv(rows)
        lines = [sentence(self.study, points) for points in self.table.values()]
        with styled():
            pictures = [self.save(figure, name, words) for figure, name, words in self.drawn()]
        sections = [("Verdicts", None, f'<p class="quiet">{LEGEND}</p>' + page.pictures(pictures))]
        if self.study.parameter:
            sections.append((f"Where verdicts change with {self.study.parameter}", None, self.thresholds()))
        sections.append(("All runs", None, page.table([name.replace("_", " ") for name in COLUMNS],
                                                      [[cell(row[name]) for name in COLUMNS] for row in rows])))  # fmt: skip
        text = page.page(self.study.title, self.study.about, self.facts(len(rows)), deck_section(self.study.cases) + sections)
        self.store.write(self.store.folder / "study.html", text.encode())
        return lines

    def facts(self, count: int) -> str:
        """What was done, in one line."""
        bounds = self.study.bounds
        return (f"{len(self.study.cases)} cases x {len(self.study.variants)} variants, {count} runs. Bounds: {bounds.unconverged:g} of the "
                f"steps unconverged, {bounds.energy:g} of the energy created, penetration {bounds.penetration:g} of the mean radius. "
                f"{self.version}; at most {self.study.seconds:g} CPU s per run.")

    def write_csv(self, rows: list[Result]) -> None:
        """All verdicts, one row per run."""
        text = csv_text([COLUMNS, *([row[name] for name in COLUMNS] for row in rows)])
        self.store.write(self.store.folder / "results.csv", text.encode())

    def drawn(self) -> Iterator[tuple[Figure, str, str]]:
        """Figures with their names and words."""
        if not self.study.parameter:
            yield verdict_drawings.matrix(self.study, self.table), "verdicts", "Verdicts of all cases by all variants"
            return
        for number, case in enumerate(self.study.cases, 1):
            chosen = {variant: points for (name, variant), points in self.table.items() if name == case.name}
            yield verdict_drawings.thresholds(self.study, case, chosen), f"thresholds-{number}", f"Verdicts of {case.name}"

    def thresholds(self) -> str:
        """A table of the values between which verdicts change."""
        rows = []
        for (case, variant), points in self.table.items():
            changes = changes_of(self.study, points)
            for change in changes:
                ends = (change.low, change.high) if change.held_below else (change.high, change.low)
                rows.append([case, variant, *(f"{end:.4g}" for end in ends), change.why])
            if not changes:
                span = f"{points[0][0].value:.4g} to {points[-1][0].value:.4g}"
                held = points[0][2]["held"]
                rows.append([case, variant, span if held else "", "" if held else span, points[0][2]["why"]])
        return page.table(["case", "variant", "holds at", "does not hold at", "why"], rows)

    def save(self, figure: Figure, name: str, words: str) -> str:
        """Write a figure as PNG; returns it for the page, as SVG."""
        self.store.write(self.store.folder / f"{name}.png", as_png(figure))
        self.figures += 1
        return embedded(figure, self.figures, words)


def row_of(point: Point) -> Result:
    """A run and its verdict as one row."""
    job, result, verdict = point
    numbers = result.get("numbers", {})
    return verdict | {"case": job.case.name, "variant": job.variant.name, "value": job.value, "status": result["status"],
                      "exit": result["code"], "cpu_seconds": result.get("cpu_seconds")} | {
                          name: numbers.get(name) for name in ("steps", "sweeps", "worst_e1", "worst_e8")}  # fmt: skip


def cell(value: object) -> object:
    """A cell of the table: yes and no for logicals."""
    return {True: "yes", False: "no"}[value] if isinstance(value, bool) else value
