"""From results to CSV, figures, tables and the page."""

import math
from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure

from ..style import as_png, styled
from . import drawings, page
from .choice_report import choice_section
from .csv_text import csv_text
from .deck_titles import deck_section
from .jobs import Job
from .measures import efforts_to_levels, errors_of, order_of
from .model import AXES, HISTORY, Case, Curves, Measure, Result, Section, Study, Table
from .profiles import profile, share, times_of
from .runner import Store
from .svg import embedded

COLUMNS = ("case", "variant", "axis", "value", "repeat", "status", "reason", "contacts", "iterations", "sweeps", "factorisations",
           "steps", "unconverged_steps", "cpu_seconds", "contact_updates", "bytes", "e1", "e2", "e8", "distance")  # fmt: skip
GOOD = ("solved", "done")
# Cases whose figures are not folded away.
OPEN = 4
# Problems of which shares are drawn as a profile: of fewer a table has all that there is.
FEWEST = 3


class Report:
    """All that is made of the results of a study."""

    def __init__(self, study: Study, jobs: list[Job], results: list[Result], store: Store, version: str):
        self.study, self.jobs, self.results, self.store, self.version = study, jobs, results, store, version
        self.figures, self.lines = 0, []
        self.series: list[str] = []
        self.table, self.traces = merged(jobs, results)
        self.errors = [errors_of(study, self.table, number) for number in range(len(study.measures))]

    def write(self) -> list[str]:
        """Write everything; returns the lines to print."""
        self.write_csv()
        self.write_histories()
        sections = []
        with styled():
            if self.study.choice:
                section, lines = choice_section(self.study, self.table, self.save)
                sections.append(section)
                self.lines += lines
            elif self.study.of_problems:
                sections += self.profiles()
            else:
                sections += [section for number in range(len(self.study.measures)) for section in self.convergence(number)]
            for number, case in enumerate(self.study.cases):
                sections.append((case.name, number < OPEN, page.pictures(self.of_case(case, number + 1))))
        sections.insert(len(sections) - len(self.study.cases), ("Error against work", None, self.legend()))
        names, rows = self.rows()
        sections.append(("All runs", None, page.table(names, rows) + '<p class="quiet">The same stands in results.csv.</p>'))
        text = page.page(self.study.title, self.study.about, self.facts(), deck_section(self.study.cases) + sections)
        self.store.write(self.store.folder / "study.html", text.encode())
        return self.lines

    def facts(self) -> str:
        """What was done, in one line."""
        failed = sum(result["status"] not in GOOD for result in self.results)
        clock = f", the shortest of {self.study.repeats} taken" if self.study.repeats > 1 else ""
        counts = ((self.study.cases, "case"), (self.study.variants, "variant"), (self.study.values, AXES[self.study.axis]))
        return (" x ".join(f"{len(items)} {name}{'s' if len(items) > 1 else ''}" for items, name in counts) +
                f": {len(self.jobs)} runs{clock}, {failed} without an answer as asked. {self.version}; at most "
                f"{self.study.seconds:g} CPU s per run.")

    def legend(self) -> str:
        """How to read the diagrams."""
        if self.study.of_problems:
            words = ("One point per tolerance; below and left is better. Hollow: the tolerance was not reached. Errors are measured from "
                     "the answers by the program (E1, E2, E8).")
            if self.study.reference:
                words += (" The distance to the reference is the energy norm of the difference of velocities over that of what contacts "
                          "change; where impulses are not unique it cannot be distinguished from zero below about 1e-8.")
            return f'<p class="quiet">{words}</p>'
        return '<p class="quiet">One point per run; below and left is better. E1 is that of the worst step.</p>'

    def write_csv(self) -> None:
        """All results, one row per run."""
        names = list(COLUMNS) + [f"error of {measure.name}" for measure in self.study.measures]
        rows = [names]
        for job, result in zip(self.jobs, self.results, strict=True):
            row = {"case": job.case.name, "variant": job.variant.name, "axis": AXES[self.study.axis], "value": job.value,
                   "repeat": job.repeat or "trace"}  # fmt: skip
            cells = [(result | row).get(name) for name in COLUMNS] + self.errors_at(job.case.name, job.variant.name, job.value)
            rows.append(cells)
        self._write_rows("results.csv", rows)

    def write_histories(self) -> None:
        """Errors within traced steps, where there are any: one row per point, and one per level that a step reaches."""
        traced = {place: result["history"] for place, result in self.table.items() if result.get("history")}
        if not traced:
            return
        places, levels = ["case", "variant", AXES[self.study.axis]], ["level", "iteration", "cpu_seconds", "messages", "bytes"]
        self._write_rows("histories.csv", [places + list(HISTORY)] + [[*place, *point] for place, points in traced.items() for point in points])
        subdomains = self.study.axis == "subdomains"
        self._write_rows("efforts.csv", [places + levels] + [
            [*place, *row] for place, points in traced.items()
            for row in efforts_to_levels([named_point(point) for point in points], place[2] if subdomains else 1)])  # fmt: skip

    def _write_rows(self, name: str, rows: list[list]) -> None:
        """A CSV file in the folder of the study."""
        self.store.write(self.store.folder / name, csv_text(rows).encode())

    def errors_at(self, case: str, variant: str, value: float) -> list:
        """Errors of all measures of a run."""
        return [dict(errors.get((case, variant), [])).get(value) for errors in self.errors]

    def profiles(self) -> list[Section]:
        """A profile for each tolerance, and the figures behind it."""
        figures, rows = [], []
        for tolerance in self.study.values:
            ratios, count = profile(times_of(self.study, self.table, tolerance))
            if count >= FEWEST:
                figure = drawings.profiles(self.study, ratios, count, f"{count} problems to E1 $\\leq$ {tolerance:g}")
                figures.append(self.save(figure, f"profile-{tolerance:g}", f"Performance profile to E1 {tolerance:g}"))
            if tolerance == min(self.study.values):
                figures += self.profiles_of_kinds(tolerance)
            for variant, values in ratios.items():
                shares = [share(values, count, tau) for tau in (1, 2, 10, math.inf)]
                rows.append([f"{tolerance:g}", variant, *(f"{100 * s:.0f} %" for s in shares)])
                self.lines.append(f"e1 <= {tolerance:g}: {variant:<16} fastest {100 * shares[0]:3.0f} %, within 10 times the fastest "
                                  f"{100 * shares[2]:3.0f} %, solves {100 * shares[3]:3.0f} %")  # fmt: skip
        words = ('<p class="quiet">Share of problems that a solver brings to the tolerance within so many times the CPU time of the '
                 "fastest (Dolan and More): at the left wins, at the right robustness.</p>")
        names = ("E1", "variant", "fastest", "within 2 times", "within 10 times", "solved")
        if not figures:
            return [("Shares of problems solved", None, page.table(names, rows))]
        return [("Performance profiles", None, words + page.pictures(figures) + "<p></p>" + page.table(names, rows))]

    def profiles_of_kinds(self, tolerance: float) -> list[str]:
        """Profiles of the cases of each kind alone, where there are several."""
        kinds = dict.fromkeys(case.kind for case in self.study.cases)
        figures = []
        for number, kind in enumerate(kinds if len(kinds) > 1 else [], 1):
            cases = [case for case in self.study.cases if case.kind == kind]
            ratios, count = profile(times_of(self.study, self.table, tolerance, cases))
            if count < FEWEST:
                continue
            title = f"{kind or 'others'}: {count} problems to E1 $\\leq$ {tolerance:g}"
            figures.append(self.save(drawings.profiles(self.study, ratios, count, title), f"profile-kind-{number}",
                                     f"Performance profile of {kind or 'others'} to E1 {tolerance:g}"))  # fmt: skip
        return figures

    def convergence(self, number: int) -> list[Section]:
        """A figure for each case: error of a measure against the axis, with its order."""
        measure, figures = self.study.measures[number], []
        for place, case in enumerate(self.study.cases, 1):
            curves = {variant: points for (name, variant), points in self.errors[number].items() if name == case.name}
            orders = {variant: order_of(points) for variant, points in curves.items()}
            for variant, order in orders.items():
                if self.study.axis == "time_steps" and order is not None:
                    self.lines.append(f"{case.name}, {variant}: error of {measure.name} is of order {order:.2f} in the time step")
            label = label_of(measure)
            shown = orders if self.study.axis == "time_steps" else {}
            figure = drawings.convergence(self.study, curves, shown, label, case.name)
            figures.append(self.save(figure, f"convergence-{number + 1}-{place}", f"{label} of {case.name}"))
        against = "its closed form"
        if not measure.closed_form:
            against = "the run on one subdomain" if self.study.axis == "subdomains" else "the run with the finest value"
        if measure.against == "first":
            against += f" of {self.study.variants[0].name}"
        over = {"end": "at the end", "mean": "mean over the run", "largest": "largest of the run"}[measure.over]
        words = f'<p class="quiet">Difference from {against}, {over}.</p>'
        return [(measure.name[0].upper() + measure.name[1:], None, words + page.pictures(figures))]

    def of_case(self, case: Case, number: int) -> list[str]:
        """Work-precision diagrams of a case."""
        figures, clocks = [], [drawings.CPU, drawings.UPDATES]
        wanted = [(name, clock) for name in drawings.ERRORS for clock in (clocks if name == "e1" else clocks[:1])]
        wanted.append(("e1", drawings.BYTES))
        if self.study.choice:
            wanted.clear()  # what is chosen by is enough
        for name, clock in wanted:
            curves = self.curves(case, lambda result, _, name=name: result.get(name), clock)
            # No figure of what is not known, or of errors that are zero throughout.
            if not any(point[0] and point[1] for points in curves.values() for point in points):
                continue
            figures.append(self.work(case, number, curves, clock, drawings.ERRORS[name], name))
        for index, measure in enumerate(self.study.measures):
            found = self.errors[index]
            pick = lambda _, key, found=found: dict(found.get(key[:2], [])).get(key[2])  # noqa: E731
            label = label_of(measure)
            for clock in (drawings.CPU, drawings.BYTES):
                curves = self.curves(case, pick, clock)
                if clock == drawings.CPU or any(point[0] and point[1] for points in curves.values() for point in points):
                    figures.append(self.work(case, number, curves, clock, label, f"measure-{index + 1}"))
        if self.study.axis == "subdomains":
            figures += self.efforts(case, number) + self.comparisons(case, number) + self.histories(case, number)
        found = {variant: self.traces[case.name, variant] for variant in self.names() if self.traces.get((case.name, variant))}
        if found:
            figure = drawings.traces(self.study, found, f"Within one run, to {min(self.study.values):g}")
            figures.append(self.save(figure, f"case-{number}-trace", f"Traces of {case.name}"))
        return figures

    def efforts(self, case: Case, number: int) -> list[str]:
        """What several subdomains take: CPU time of all, bytes that they exchange, sweeps."""
        figures = []
        for name, label in (drawings.CLOCKS | {"sweeps": "sweeps [-]"}).items():
            curves = {variant: [(value, result[name]) for value in self.study.values
                                if (result := self.table.get((case.name, variant, value))) and result.get(name)]
                      for variant in self.names()}  # fmt: skip
            figure = drawings.convergence(self.study, curves, {}, label, case.name)
            figures.append(self.save(figure, f"case-{number}-subdomains-{name}", f"{label} of {case.name} against subdomains"))
        return figures

    def comparisons(self, case: Case, number: int) -> list[str]:
        """Error of all variants against CPU time, messages and bytes within a traced step, a figure for each number of subdomains."""
        figures = []
        for value in self.study.values:
            found = {variant: [named_point(point) for point in result["history"]] for variant in self.names()
                     if (result := self.table.get((case.name, variant, value))) and result.get("history")}  # fmt: skip
            if len(found) > 1:
                figure = drawings.comparison(self.study, found, value, f"{case.name}, {value:g} subdomain{'s' if value > 1 else ''}")
                figures.append(self.save(figure, f"case-{number}-effort-{value:g}", f"E8 against effort on {value:g}: {case.name}"))
        return figures

    def histories(self, case: Case, number: int) -> list[str]:
        """Error against iterations and CPU time within a traced step, a figure for each variant and clock."""
        figures = []
        for place, variant in enumerate(self.names(), 1):
            found = {f"{value:g}": result["history"] for value in self.study.values
                     if (result := self.table.get((case.name, variant, value))) and result.get("history")}  # fmt: skip
            for column, label in enumerate(("iterations [-]", drawings.CLOCKS[drawings.CPU])) if found else ():
                curves = {name: [(point[column], point[2]) for point in points if point[column] > 0 and point[2] > 0]
                          for name, points in found.items()}  # fmt: skip
                figure = drawings.histories({name: points for name, points in curves.items() if points}, label, f"{case.name}, {variant}")
                clock = ("iterations", "cpu")[column]
                figures.append(self.save(figure, f"case-{number}-history-{place}-{clock}", f"E8 within a step of {case.name}, {variant}"))
        return figures

    def work(self, case: Case, number: int, curves: Curves, clock: str, label: str, name: str) -> str:
        """One work-precision diagram."""
        figure = drawings.work_precision(self.study, case, curves, clock, label, case.name)
        against = {drawings.CPU: "", drawings.UPDATES: "-updates", drawings.BYTES: "-bytes"}[clock]
        return self.save(figure, f"case-{number}-{name}{against}", f"{label} against {drawings.CLOCKS[clock]} of {case.name}")

    def curves(self, case: Case, error_of: Callable[[Result, tuple[str, str, float]], float | None], clock: str) -> Curves:
        """Points of every variant: work, error, and whether it arrived."""
        found = {}
        for variant in self.names():
            points = []
            for value in self.study.values:
                result = self.table.get((case.name, variant, value))
                if result:
                    points.append((result.get(clock), error_of(result, (case.name, variant, value)), result["status"] in GOOD))
            found[variant] = points
        return found

    def names(self) -> list[str]:
        """Names of the variants."""
        return [variant.name for variant in self.study.variants]

    def rows(self) -> tuple[list[str], list[list]]:
        """The table of the page: the shortest of the repeats."""
        kept = [name for name in COLUMNS[5:] if name != "reason" and any(r.get(name) is not None for r in self.table.values())]
        rows = [[case, variant, value, *(result.get(name) for name in kept), *self.errors_at(case, variant, value)]
                for (case, variant, value), result in self.table.items()]  # fmt: skip
        names = ["case", "variant", AXES[self.study.axis], *(name.replace("_", " ") for name in kept)]
        return names + [f"error of {measure.name}" for measure in self.study.measures], rows

    def save(self, figure: Figure, name: str, words: str) -> str:
        """Write a figure as PNG; returns it for the page, as SVG."""
        self.store.write(self.store.folder / f"{name}.png", as_png(figure))
        self.figures += 1
        return embedded(figure, self.figures, words, self.series)


def named_point(point: list[float]) -> dict[str, float]:
    """A point of a history by names of its columns."""
    return dict(zip(HISTORY, point, strict=True))


def label_of(measure: Measure) -> str:
    """The error of a measure as an axis names it: the measure itself where it should be zero."""
    name = measure.name if measure.closed_form in ("0", "0.0") else f"error of {measure.name}"
    return name + (f" [{measure.unit}]" if measure.unit else "")


def merged(jobs: list[Job], results: list[Result]) -> tuple[Table, dict[tuple[str, str], Any]]:
    """Results by (case, variant, value), the fastest repeat of each; and traces by (case, variant)."""
    table, traces = {}, {}
    for job, result in zip(jobs, results, strict=True):
        if job.repeat == 0:
            traces[job.case.name, job.variant.name] = result.get("trace")
            continue
        place = (job.case.name, job.variant.name, job.value)
        seconds = result.get("cpu_seconds")
        if place not in table or (seconds is not None and seconds < (table[place].get("cpu_seconds") or math.inf)):
            table[place] = result
    return table, traces
