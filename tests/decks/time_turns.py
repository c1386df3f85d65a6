#!/usr/bin/env python3
"""CPU seconds of whole runs, in turns: time_turns.py 'PROGRAM run DECK [OPTION...]' ['PROGRAM run DECK ...'...]

Every command runs in an empty folder, one after the other, and all of them again for some rounds: what slows the machine for a
while slows all of them. Words of a command that name files or folders are meant from here. A row of the table, which is in
Markdown, has CPU seconds of a command (its own and those of what it starts; least and median of all rounds), the least, median
and most of its ratios to the first command in the same round, and, of its last run, steps, contact updates and the volume error
at the end.
"""

import argparse
import json
import os
import shlex
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

COLUMNS = ("command", "CPU s, least", "CPU s, median", "ratio, least", "ratio, median", "ratio, most", "steps", "contact updates",
           "volume error")


def words_of(command):
    """The words of a command, files and folders by their whole path; the second one is no file, whatever there is of its name."""
    words = shlex.split(command)
    return [str(Path(word).resolve()) if i != 1 and Path(word).exists() else word for i, word in enumerate(words)]


def run(words):
    """Run a command in an empty folder: its CPU seconds and its `run.json`."""
    before = os.times()
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
        after = os.times()
        if done.returncode:
            raise SystemExit(f"{shlex.join(words)} ended with {done.returncode}:\n{done.stderr}")
        found = list(Path(folder).rglob("run.json"))
        if len(found) != 1:
            raise SystemExit(f"{shlex.join(words)} leaves {len(found)} files run.json in its folder, not one")
        summary = json.loads(found[0].read_text())
    return after.children_user + after.children_system - before.children_user - before.children_system, summary


def rows_of(names, seconds, summaries):
    """Rows of the table: seconds of each command by round, and the summary of its last run."""
    for name, own, summary in zip(names, seconds, summaries, strict=True):
        ratios = [one / first for one, first in zip(own, seconds[0])]
        yield [name, f"{min(own):.2f}", f"{statistics.median(own):.2f}",
               *(f"{of(ratios):.3f}" for of in (min, statistics.median, max)),
               str(summary["steps"]), f"{summary['contact_updates']:,}", f"{summary.get('volume_error', float('nan')):.2e}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("commands", nargs="+", metavar="COMMAND", help="a run, as one word: 'PROGRAM run DECK [OPTION...]'")
    parser.add_argument("--rounds", type=int, default=7)
    chosen = parser.parse_args()
    commands = [words_of(command) for command in chosen.commands]
    seconds, summaries = [[] for _ in commands], [None] * len(commands)
    for round_number in range(chosen.rounds):
        for i, words in enumerate(commands):
            time, summaries[i] = run(words)
            seconds[i].append(time)
        print(f"round {round_number + 1}: " + ", ".join(f"{own[-1]:.2f}" for own in seconds), file=sys.stderr, flush=True)
    print("| " + " | ".join(COLUMNS) + " |\n" + "|---" * len(COLUMNS) + "|")
    for row in rows_of(chosen.commands, seconds, summaries):
        print("| " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
