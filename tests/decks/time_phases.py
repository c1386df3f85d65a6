#!/usr/bin/env python3
"""Milliseconds per step by phase, of scenes at rest: time_phases.py PROGRAM [PROGRAM...] [DECK.toml...]

Each deck, by default those of `input_decks/engines`, runs once, without pushes, until its grains rest; that state stays in
the folder of states. Every program then goes on from it, in turns, by steps of a fixed number of plain sweeps: a few of them,
and some more, from which follow the cost of a sweep and the fixed cost of a solve in sweeps. Every step is recorded, so that
`measure` is the cost of a recorded step; `step` leaves it out, as it leaves out the output. Measures leave the caches to the
next step as nothing else does: with `--set output.record_every=20` times are means over 20 steps of which one is recorded.
Of several rounds the one with the least time counts; or, with `--share 0.1`, what the least tenth of all single steps takes,
which scatters less where other processes come and go. Times are CPU times; with `--ranks` or `--threads` each program runs on
each of the numbers given, in turns too, and times are by the clock, of the first rank. Tables are in Markdown.
"""

import argparse
import csv
import json
import math
import subprocess
from pathlib import Path

DECKS = Path(__file__).resolve().parents[2] / "input_decks" / "engines"
PHASES = ("predict", "detect", "assemble", "solve", "update")
#: Settings of all runs: pushes would come and go with the overlap that sweeps leave
ALWAYS = {"time.recovery": "0"}
#: Settings of timed steps: plain sweeps, as many as asked for, between one test before and one after them
TIMED = {"solver.method": '"nlgs"', "solver.tolerance": "1e-40", "output.record_every": "1", "restart.every": "0"}
#: Steps before the first that counts, which look for neighbours again
FIRST_STEPS = 10


class Variant:
    """A program on a number of ranks and threads, and the clock that times it: `cpu` or `wall`."""

    def __init__(self, program, launcher="", ranks=1, threads=1, clock="cpu"):
        self.words = [launcher, "--oversubscribe", "-n", str(ranks), program] if ranks > 1 else [program]
        self.settings = {"solver.threads": threads, "solver.order": "coloured"} if threads > 1 else {}
        self.clock = clock
        self.name = ", ".join([Path(program).name, *count(ranks, "rank"), *count(threads, "thread")])


def count(number, what):
    """A number of things in words, unless it is one."""
    return [f"{number} {what}s"] if number > 1 else []


def run(variant, deck, results, settings, *words):
    """Run a deck with settings laid over it, for a folder of results that it may replace."""
    command = [*variant.words, "run", str(deck), "--quiet", "--force", "--output", str(results), *words]
    for key, value in (settings | variant.settings).items():
        command += ["--set", f"{key}={value}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr)
    return json.loads((results / "run.json").read_text())


def settle(variant, deck, state, settings):
    """The state of a deck at its end, made unless it is there."""
    summary = state / "run.json"
    if summary.exists() and json.loads(summary.read_text())["status"] == "done":
        return json.loads(summary.read_text())
    return run(variant, deck, state, settings)


def time_steps(variant, deck, state, settings, sweeps, steps):
    """Go on from a state: milliseconds of each phase in single steps, and the last row of the record."""
    done = json.loads((state / "run.json").read_text())["steps"]
    more = {"solver.maximum_sweeps": sweeps, "solver.check_every": sweeps, "time.steps": done + FIRST_STEPS + steps}
    results = state.with_name(state.name + ".timed")
    run(variant, deck, results, TIMED | settings | more, "--restart", str(state))
    with open(results / "record.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if int(row["step"]) >= done + FIRST_STEPS]
    return phases_of(rows, variant.clock), rows[-1]


def phases_of(rows, clock):
    """Milliseconds per step of each phase between rows of a record that follow each other."""
    numbers, phases = [int(row["step"]) for row in rows], {}
    for name in (*PHASES, "measure"):
        totals = [1e3 * float(row[f"{clock}_{name}"]) for row in rows]
        phases[name] = [(totals[i] - totals[i - 1]) / (numbers[i] - numbers[i - 1]) for i in range(1, len(rows))]
    phases["step"] = [sum(parts) for parts in zip(*(phases[name] for name in PHASES))]
    return phases


def summary(rounds, share):
    """Milliseconds of each phase: means of the cheapest round, or what a share of the single steps of all rounds stays below."""
    if share is None:
        cheapest = min(rounds, key=lambda phases: sum(phases["step"]))
        return {name: sum(times) / len(times) for name, times in cheapest.items()}
    together = {name: sorted(time for phases in rounds for time in phases[name]) for name in rounds[0]}
    return {name: times[int(share * len(times))] for name, times in together.items()}


def measure(variants, deck, state, settings, sweeps, steps, rounds, share):
    """Rows of a table, one per variant: phases, cost of a sweep, fixed cost of a solve in sweeps."""
    timed = [{n: [] for n in sweeps} for _ in variants]
    rows = [{} for _ in variants]
    few, many = sweeps
    for _ in range(rounds):
        for variant, times, row in zip(variants, timed, rows):
            for n in sweeps:
                phases, record = time_steps(variant, deck, state, settings, n, steps)
                times[n].append(phases)
                if n == few:
                    row["record"] = record
    for times, row in zip(timed, rows):
        row |= {n: summary(times[n], share) for n in sweeps}
        row["sweep"] = (row[many]["solve"] - row[few]["solve"]) / (many - few)
        row["fixed"] = row[few]["solve"] / row["sweep"] - few if row["sweep"] > 0 else math.nan
    return rows


def line(deck, variant, row, sweeps, radius):
    """One variant's row of a table."""
    record, phases = row["record"], row[sweeps[0]]
    texts = [deck.stem, variant.name, f"{int(record['contacts']):,}", f"{int(record['active_contacts']):,}"]
    texts += [f"{phases[name]:.2f}" for name in (*PHASES, "step", "measure")]
    texts += [f"{row['sweep']:.3f}", f"{row['fixed']:.1f}"]
    texts += [f"{float(record['mean_velocity']):.1e}", f"{float(record['mean_penetration']) / radius:.1e}"]
    return "| " + " | ".join([*texts, f"{float(record['floor_share']):.4f}"]) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", help="programs, and decks in place of those of input_decks/engines")
    parser.add_argument("--states", default="engines.states", help="folder of the states at rest (default: engines.states)")
    parser.add_argument("--steps", type=int, default=40, help="steps that are timed")
    parser.add_argument("--sweeps", type=int, nargs=2, default=(8, 48), help="sweeps per step: few and many")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--share", type=float, help="share of single steps, 0 to below 1, that take no longer than the times shown "
                        "(default: means of the cheapest round)")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1], help="numbers of ranks")
    parser.add_argument("--threads", type=int, nargs="+", default=[1], help="numbers of threads of each rank")
    parser.add_argument("--launcher", default="mpiexec", help="what starts several ranks")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="setting of all runs")
    chosen = parser.parse_args()
    decks = [Path(name) for name in chosen.files if name.endswith(".toml")] or sorted(DECKS.glob("*.toml"))
    programs = [str(Path(name).resolve()) for name in chosen.files if not name.endswith(".toml")]
    clock = "wall" if max(chosen.ranks + chosen.threads) > 1 else "cpu"
    variants = [Variant(program, chosen.launcher, ranks, threads, clock) for program in programs for ranks in chosen.ranks
                for threads in chosen.threads]
    settings = ALWAYS | dict(text.split("=", 1) for text in chosen.set)
    columns = ["scene", "program", "contacts", "that carry", *PHASES, "step", "measure", "ms per sweep", "fixed, sweeps",
               "mean speed, m/s", "mean overlap / r", "floor share"]
    print("| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|", flush=True)
    for deck in decks:
        state = Path(chosen.states) / deck.stem
        radius = settle(Variant(programs[0]), deck, state, settings)["mean_radius"]
        rows = measure(variants, deck, state, settings, chosen.sweeps, chosen.steps, chosen.rounds, chosen.share)
        for variant, row in zip(variants, rows):
            print(line(deck, variant, row, chosen.sweeps, radius), flush=True)


if __name__ == "__main__":
    main()
