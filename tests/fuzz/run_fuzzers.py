#!/usr/bin/env python3
"""All fuzzers one after the other, and their table.

    run_fuzzers.py PROGRAM [--seed N] [--minutes N] [--table PAGE] [--keep FOLDER]

Every `fuzz_<kind>.py` of this folder gets the same share of the time. `--table` replaces the lines between the two marks of a
page by the table. The exit code is 1 when a case crashed, hung or was wrong, or when a fuzzer itself failed.
"""

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
COLUMNS = ("tried", "clean", "refused", "crashed", "hung", "wrong")
BEGIN, END = "<!-- fuzz: begin -->\n", "<!-- fuzz: end -->\n"


def main():
    """Run the fuzzers and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=1, help="CPU minutes of all runs together")
    parser.add_argument("--table", type=Path, metavar="PAGE", help="page whose table is replaced")
    parser.add_argument("--keep", default="fuzz", help="folder for the cases that fail")
    chosen = parser.parse_args()
    fuzzers = sorted(path for path in HERE.glob("fuzz_*.py") if path.stem != "fuzz_harness")
    seconds = 60 * chosen.minutes / len(fuzzers)
    found, failed = [], []
    for fuzzer in fuzzers:
        done = subprocess.run([sys.executable, fuzzer, chosen.program, "--seed", str(chosen.seed), "--seconds", f"{seconds:.1f}",
                               "--keep", chosen.keep], stdout=subprocess.PIPE, text=True, check=False)
        *said, last = done.stdout.splitlines() or [""]
        print("\n".join(said), end="\n" if said else "", flush=True)
        try:
            found.append(json.loads(last))
        except ValueError:
            print(f"{fuzzer.name} ended with {done.returncode} and without counts: {last}", flush=True)
            failed.append(fuzzer.stem)
            continue
        if done.returncode:
            failed.append(found[-1]["kind"])
    text = table(found, chosen)
    print(text, end="")
    if chosen.table:
        page = chosen.table.read_text(encoding="utf8")
        chosen.table.write_text(re.sub(f"{BEGIN}.*{END}", lambda _: BEGIN + text + END, page, flags=re.S), encoding="utf8")
    if failed:
        print("faults in: " + ", ".join(failed))
    return 1 if failed else 0


def table(found, chosen):
    """The counts as a table of Markdown."""
    lines = [f"Seed {chosen.seed}, {chosen.minutes:g} CPU minutes:", "", "| kind | " + " | ".join(COLUMNS) + " |",
             "|---|" + "---:|" * len(COLUMNS)]
    for row in found:
        lines.append(f"| {row['kind'].replace('_', ' ')} | " + " | ".join(str(row[column]) for column in COLUMNS) + " |")
    return "\n" + "\n".join(lines) + "\n\n"


if __name__ == "__main__":
    sys.exit(main())
