#!/usr/bin/env python3
"""Solve contact problems by Siconos and by `splitgrain solve`, side by side: error against CPU time.

usage: compare_siconos.py PROGRAM [--seconds S] [--jobs N] [--only WORD ...]
                          [--results FILE.json] [--write FILE] [--picture FILE.png]

Needs the Python bindings of Siconos (Debian: python3-siconos), h5py, scipy and matplotlib; without Siconos one sentence is
said and nothing is done. --results keeps what was measured, and measures only what is not there yet.
Problems are the files of ${SPLITGRAIN_SHARED}/problems or ../shared/problems beside the source, where there are any, and some of input_decks, dumped here. Errors of both are recomputed by numpy from W, q, mu and r.

Exit code 1 when an error that `splitgrain solve` prints is not that of its answer, when its default solver leaves a problem
above e1 = 1e-8, or when Siconos finds a larger error in an answer than we do. Times are not judged.
"""

import argparse
import csv
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

from own_problems import LARGE, SMALL, SOURCE, dump

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from manual_pages import put, table

WORKER = Path(__file__).with_name("siconos_worker.py")
TOLERANCE = 1e-8
RESOLUTION = 3e-4
"""CPU seconds that clocks tell apart"""
LOCK = threading.Lock()
OURS = ("auto", "nlgs", "nesterov", "accelerated", "proximal", "interior")
# One thread each: both codes are measured in CPU seconds of one core.
ENVIRONMENT = os.environ | dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

@dataclass
class Run:
    """What one solver made of one problem: points (CPU seconds, e1); the last of ours and all of theirs are recomputed."""

    points: list = field(default_factory=list)
    last: str = ""

    def seconds_to(self, tolerance):
        """Least CPU seconds to this e1; None when never reached."""
        return min((seconds for seconds, e1 in self.points if e1 <= tolerance), default=None)

    def as_list(self):
        return [self.points, self.last]

    def lowest(self):
        return min((e1 for _, e1 in self.points), default=float("inf"))


@dataclass
class Problem:
    name: str
    file: Path
    dimension: int = 3
    contacts: int = 0
    ours: dict = field(default_factory=dict)
    theirs: dict = field(default_factory=dict)


def shared_problems():
    folder = Path(os.environ.get("SPLITGRAIN_SHARED") or SOURCE.parent / "shared") / "problems"
    if not folder.is_dir():
        print(f"no problems of other codes in {folder}: only our own are solved")
    return [Problem(file.stem, file) for file in sorted(folder.glob("*.hdf5"))]


def dumped_problems(program, place):
    """Problems of steps of our own decks."""
    return [Problem(name, dump(program, place, name)) for name in SMALL | LARGE]


def solve_here(program, problem, solver, seconds, place, mistakes):
    """One of our solvers: its trace, and its answer's errors recomputed; mistakes are added to the list."""
    from contact_problem import errors, read_answer, read_problem

    file, trace = place / "answer.hdf5", place / "trace.csv"
    shutil.copyfile(problem.file, file)
    done = subprocess.run([program, "solve", file, "--solver", solver, "--tolerance", str(TOLERANCE), "--seconds", str(seconds),
                           "--json", "--trace", trace, "--write", "--force"], capture_output=True, text=True, env=ENVIRONMENT)
    if done.returncode not in (0, 3):
        mistakes.append(f"{problem.name}, {solver}: {done.stderr or done.stdout}")
        return Run(last="failed")
    row = json.loads(done.stdout)
    answer = read_answer(file)
    again = errors(read_problem(problem.file), answer)
    mistakes += check(problem, solver, row, answer, again, place)
    with open(trace, newline="") as rows:
        points = [(float(point["cpu_seconds"]), float(point["e1"])) for point in csv.DictReader(rows)]
    return Run([*points, (row["cpu_seconds"], again.e1)])


def check(problem, solver, row, answer, again, place):
    """What is wrong with an answer and its printed figures, as sentences."""
    import numpy as np

    # The program takes largest eigenvalues from 256th powers: to 1e-3 at worst, where two are nearly alike.
    for name, share in (("e1", 1e-6), ("e2", 1e-6), ("e8", 1e-3)):
        if abs(row[name] - getattr(again, name)) > share * row[name] + again.rounding:
            yield f"{problem.name}, {solver}: {name} is {getattr(again, name):.3e}, printed {row[name]:.3e}"
    if solver == "auto" and again.e1 > TOLERANCE:
        yield f"{problem.name}: the default solver stays at e1 = {again.e1:.1e}"
    if problem.dimension == 3:
        np.save(place / "answer.npy", answer)
        command = [sys.executable, WORKER, "error", problem.file, place / "answer.npy"]
        own = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT)
        found = json.loads(own.stdout)["error"] if own.returncode == 0 else float("nan")
        if not abs(found - again.e2) <= 1e-6 * again.e2 + again.rounding:
            yield f"{problem.name}, {solver}: Siconos finds an error of {found:.3e}, we an e2 of {again.e2:.3e}"


def solve_there(problem, solver, seconds):
    """One solver of Siconos, a point a tolerance; whether the process survived them all."""
    command = [sys.executable, str(WORKER), "solve", str(problem.file), solver, str(seconds)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT, timeout=60 + 30 * seconds)
        output, code = done.stdout, done.returncode
    except subprocess.TimeoutExpired as error:
        output, code = (error.stdout or b"").decode(), "time"
    rows = [json.loads(line) for line in output.splitlines() if line.endswith("}")]
    ended = {0: "", -24: "", "time": ""}.get(code, "crashes")
    return Run([(row["cpu_seconds"], row["e1"]) for row in rows], ended)


def measure(program, problem, seconds, place, mistakes):
    """All solvers on one problem."""
    from contact_problem import read_problem

    read = read_problem(problem.file)
    problem.dimension, problem.contacts = read.dimension, read.contacts
    place.mkdir()
    for solver in OURS:
        problem.ours[solver] = solve_here(program, problem, solver, seconds, place, mistakes)
    for solver in json.loads(subprocess.check_output([sys.executable, WORKER, "list", str(problem.dimension)])):
        problem.theirs[solver] = solve_there(problem, solver, seconds)
    print(f"{problem.name}: {problem.contacts} contacts, "
          f"ours {show(problem.ours['auto'])} (best {best(problem.ours)}), Siconos {best(problem.theirs)}", flush=True)


def measure_and_keep(program, problem, asked, place, mistakes):
    """Measure, and write it down."""
    try:
        measure(program, problem, asked.seconds, place / f"{problem.name} answers", mistakes)
    except Exception as error:
        mistakes.append(f"{problem.name}: {error!r}")
        return
    if asked.results:
        with LOCK:
            kept = json.loads(asked.results.read_text()) if asked.results.exists() else {}
            kept[problem.name] = [problem.dimension, problem.contacts,
                                  *({name: run.as_list() for name, run in side.items()} for side in (problem.ours, problem.theirs))]
            asked.results.write_text(json.dumps(kept))


def recall(problem, results):
    """Take what was measured earlier; true when there is something."""
    kept = json.loads(results.read_text()) if results and results.exists() else {}
    if problem.name not in kept:
        return False
    problem.dimension, problem.contacts, *sides = kept[problem.name]
    problem.ours, problem.theirs = ({name: Run(*run) for name, run in side.items()} for side in sides)
    return True


def show(run):
    """Seconds to the tolerance, or the lowest error in parentheses."""
    seconds = run.seconds_to(TOLERANCE)
    if seconds is not None:
        return f"{seconds:.2g}" if seconds >= RESOLUTION else f"< {RESOLUTION:g}"
    return run.last or (f"({run.lowest():.0e})" if run.points else "(no answer)")


def best(runs):
    """The fastest of some solvers, by name and time."""
    solved = [(run.seconds_to(TOLERANCE), name) for name, run in runs.items() if run.seconds_to(TOLERANCE) is not None]
    return f"{min(solved)[1]} {show(runs[min(solved)[1]])}" if solved else "none"


def tables(problems, seconds):
    """All tables in Markdown."""
    yield (f"Measured {time.strftime('%Y-%m-%d')} on {processor()}, one core, at most {seconds:g} CPU s per solve. CPU seconds to "
           f"e1 <= {TOLERANCE:g}, recomputed; in parentheses the lowest e1 where that was not reached.\n")
    yield "### The best of both\n"
    yield table(["problem", "contacts", "our default", "our best", "best of Siconos", "best of both codes"],
                [[p.name, p.contacts, show(p.ours["auto"]), best(p.ours), best(p.theirs), winner(p)] for p in problems])
    yield "### Ours\n"
    yield solver_table(problems, "ours")
    for dimension in (3, 2):
        chosen = [p for p in problems if p.dimension == dimension]
        if chosen:
            yield f"### Siconos, in {'space' if dimension == 3 else 'the plane'}\n"
            yield solver_table(chosen, "theirs")


def winner(problem):
    """Which code is faster, each by its best solver; a tie within a factor of 1.5, or where clocks do not tell."""
    ours, theirs = (min((t for run in runs.values() if (t := run.seconds_to(TOLERANCE)) is not None), default=float("inf"))
                    for runs in (problem.ours, problem.theirs))
    if ours == theirs == float("inf"):
        return "none"
    if float("inf") in (ours, theirs):
        return "Siconos alone" if ours > theirs else "ours alone"
    if max(ours, theirs) <= max(1.5 * min(ours, theirs), RESOLUTION):
        return "as fast"
    return f"ours, {theirs / ours:.2g} times" if ours < theirs else f"Siconos, {ours / theirs:.2g} times"


def solver_table(problems, side):
    names = list(getattr(problems[0], side))
    rows = [[p.name, *(show(getattr(p, side)[name]) for name in names)] for p in problems]
    count = [sum(getattr(p, side)[name].seconds_to(TOLERANCE) is not None for p in problems) for name in names]
    return table(["problem", *names], [*rows, [f"solved, of {len(problems)}", *count]])


def processor():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def draw(problems, file):
    """Error against CPU time, a panel a problem."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    columns = 4
    rows = -(-len(problems) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(4 * columns, 3 * rows), squeeze=False)
    for axis, problem in zip(axes.flat, problems):
        for style, runs in (("-", problem.ours), ("--", problem.theirs)):
            for colour, (name, run) in enumerate(runs.items()):
                points = [(max(t, 1e-5), max(e1, 1e-16)) for t, e1 in sorted(run.points) if e1 < 1e3]
                if points:
                    label = name if style == "-" else f"Siconos {name}"
                    axis.loglog(*zip(*points), style, marker="." if style == "--" else None, color=f"C{colour}", lw=1, label=label)
        axis.axhline(TOLERANCE, color="0.6", lw=0.6)
        axis.set_ylim(1e-13, 2)
        axis.set_title(f"{problem.name} ({problem.contacts})", fontsize=8)
        axis.tick_params(labelsize=7)
    for axis in axes.flat[len(problems):]:
        axis.axis("off")
    space = next((axis for axis, problem in zip(axes.flat, problems) if problem.dimension == 3), axes.flat[0])
    figure.legend(*space.get_legend_handles_labels(), loc="lower center", ncol=5, fontsize=8)
    figure.supxlabel("CPU time [s]", y=0.65 / (3 * rows), fontsize=9)
    figure.supylabel("e1", fontsize=9)
    figure.tight_layout(rect=(0.01, 0.9 / (3 * rows), 1, 1))
    figure.savefig(file, dpi=80)


def arguments():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--only", nargs="+", default=[""])
    parser.add_argument("--results", type=Path)
    parser.add_argument("--write")
    parser.add_argument("--picture")
    return parser.parse_args()


def main():
    missing = [name for name in ("siconos", "h5py", "scipy", "matplotlib") if find_spec(name) is None]
    if missing:
        print(f"skipped: {sys.executable} has no {', '.join(missing)} (Debian: python3-siconos and others)")
        return
    asked = arguments()
    program = asked.program.resolve()
    mistakes = []
    with tempfile.TemporaryDirectory(prefix="splitgrain ") as folder:
        place = Path(folder)
        problems = [p for p in [*shared_problems(), *dumped_problems(program, place)] if any(w in p.name for w in asked.only)]
        with ThreadPoolExecutor(asked.jobs) as pool:
            for problem in problems:
                if not recall(problem, asked.results):
                    pool.submit(measure_and_keep, program, problem, asked, place, mistakes)
        problems = [problem for problem in problems if problem.ours and problem.theirs]
    text = "\n".join(tables(problems, asked.seconds))
    print(text)
    if asked.write:
        put(asked.write, "tables", text)
    if asked.picture:
        draw(problems, asked.picture)
    sys.exit("\n".join(mistakes) or 0)


if __name__ == "__main__":
    main()
