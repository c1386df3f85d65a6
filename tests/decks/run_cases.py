#!/usr/bin/env python3
"""Run the regression cases and compare the numbers that they write with those that are right.

Usage: run_cases.py PROGRAM [CASE ...] [--accept]

A case is a folder here: deck.toml with all that it names, and numbers.tag, which a run of it wrote. A difference fails when
it is above the tolerance of its kind, or of its name where that stands in TOLERANCES or in the case's own tolerances.toml
(name or kind = [relative, absolute]). --accept takes the numbers of this run for right.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

CASES = Path(__file__).resolve().parent

# Relative and absolute. Steps are solved far, and runs are so short that even another order of the sweep leaves energies and
# velocities within 1e-5, and forces and the deepest penetration, which hang more on the last sweep, within 1e-3. How many
# contacts have a gap below zero, over which penetrations are averaged, may hang on rounding, and so may which of them slide.
# Sweeps differ by a few tests.
TOLERANCES = {
    "count": (0.0, 0.5),
    "effort": (0.15, 0.0),
    "measure": (1e-5, 1e-9),
    "energy_closure": (0.0, 1e-9),
    "mean_penetration": (1.0, 1e-9),
    "sliding_share": (0.0, 0.05),
} | dict.fromkeys(("max_penetration", "worst_penetration", "pressure", "floor_share", "mobilised_friction"), (1e-3, 1e-9)) \
  | {f"stress_{a}{b}": (1e-3, 1e-9) for a in "xyz" for b in "xyz"}
# Components of one vector or tensor: a small one is as exact as the largest, not more.
FAMILIES = ("stress_", "momentum_", "fabric_")


def read_tags(file):
    """Quantities of a file of tagged numbers: name -> (kind, numbers)."""
    words = iter(file.read_text().split())
    return {name: (next(words), [float(next(words)) for _ in range(int(next(words)))]) for name in words}


def differences(wanted, got, tolerances):
    """What differs, one sentence each."""
    found = [f"{name} is {'new' if name in got else 'missing'}" for name in sorted(wanted.keys() ^ got.keys())]
    for name in wanted.keys() & got.keys():
        kind, numbers = wanted[name]
        relative, absolute = tolerances.get(name, tolerances[kind])
        mine = got[name][1]
        if len(mine) != len(numbers):
            found.append(f"{name} has {len(mine)} numbers, not {len(numbers)}")
            continue
        family = next((f for f in FAMILIES if name.startswith(f)), name)
        largest = max((abs(x) for other in wanted if other.startswith(family) for x in wanted[other][1]), default=0)
        limit = absolute + relative * largest
        for a, b in zip(mine, numbers):
            if not abs(a - b) <= limit:
                found.append(f"{name} is {a:.17g}, not {b:.17g} within {limit:.2g}")
    return sorted(found)


def run_case(program, case, results):
    """Run a case; an error as one sentence, or None."""
    done = subprocess.run([program, "run", case / "deck.toml", "--output", results, "--quiet", "--force"],
                          capture_output=True, text=True)
    return f"exit code {done.returncode}: {done.stderr.strip()}" if done.returncode else None


def judge(program, case, results, accept):
    """All that is wrong with a case."""
    error = run_case(program, case, results)
    if error:
        return [error]
    if accept:
        shutil.copy(results / "numbers.tag", case)
        return []
    if not (case / "numbers.tag").exists():
        return ["has no numbers.tag"]
    tolerances = dict(TOLERANCES)
    own = case / "tolerances.toml"
    if own.exists():
        tolerances |= tomllib.loads(own.read_text())
    return differences(read_tags(case / "numbers.tag"), read_tags(results / "numbers.tag"), tolerances)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("cases", nargs="*", metavar="CASE")
    parser.add_argument("--accept", action="store_true")
    arguments = parser.parse_args()
    names = arguments.cases or sorted(deck.parent.name for deck in CASES.glob("*/deck.toml"))
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            wrong = judge(arguments.program.resolve(), CASES / name, Path(folder) / name, arguments.accept)
            failed += bool(wrong)
            print(f"{'FAIL' if wrong else 'ok':5}{name}")
            for sentence in wrong:
                print(f"      {sentence}")
    print(f"{len(names) - failed} passed, {failed} failed")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
