#!/usr/bin/env python3
"""Run a deck on one rank and on two, in turns, and say what two give: compare_ranks.py PROGRAM [--rounds 7]

Each round runs `long_box.toml` on one rank and on two, then a box of half its length alone, then two such halves at the
same time that know nothing of each other. What those lose beside the one alone the machine loses: caches, memory and
whatever else runs. The table is in Markdown; nothing is asserted about times. Two cores with nothing else to do are meant.
"""

import argparse
import json
import os
import statistics
import subprocess
import tempfile
from pathlib import Path

DECK = Path(__file__).resolve().parents[2] / "input_decks" / "decomposition" / "long_box.toml"
#: Lengths of the box and of the wall in the deck, and what they are in a box of half the length.
HALF = (("8.0", "4.0"), ("8.01", "4.01"), ("8.1", "4.1"))


def half_of(text):
    """The deck of half the length: every one of its lengths must be there."""
    for whole, half in HALF:
        if whole not in text:
            raise SystemExit(f"compare_ranks: {DECK} has no length {whole} any more")
    for whole, half in reversed(HALF):
        text = text.replace(whole, half)
    return text


def run(commands, places):
    """Run commands at the same time, each with its folder of results; the records of the runs."""
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    # Open MPI puts sockets into TMPDIR, and their paths must be short.
    environment.pop("TMPDIR", None)
    started = [subprocess.Popen([*command, "--quiet", "--output", str(place)], env=environment, stdout=subprocess.DEVNULL)
               for command, place in zip(commands, places)]
    if any([process.wait() for process in started]):
        raise SystemExit("compare_ranks: a run failed")
    return [json.loads((place / "run.json").read_text()) for place in places]


def one_round(program, half, place):
    alone = [program, "run", str(DECK)]
    one, = run([alone], [place / "one"])
    two, = run([["mpiexec", "-n", "2", *alone]], [place / "two"])
    halves = [program, "run", str(half)]
    single, = run([halves], [place / "half"])
    both = run([halves, halves], [place / "left", place / "right"])
    return one, two, single, both


def row(name, rounds, key):
    """Sums over rounds, efficiency of the sums and its range over rounds, of one kind of seconds."""
    one = [r[0][key] for r in rounds]
    two = [r[1][key] for r in rounds]
    single = [r[2][key] for r in rounds]
    both = [max(half[key] for half in r[3]) for r in rounds]
    each = [a / b / 2 for a, b in zip(one, two)]
    machine = [a / b for a, b in zip(single, both)]
    return (f"| {name} | {sum(one):.1f} | {sum(two):.1f} | {sum(one) / sum(two) / 2:.2f} | {min(each):.2f} to {max(each):.2f} "
            f"(median {statistics.median(each):.2f}) | {sum(single):.1f} | {sum(both):.1f} | {sum(single) / sum(both):.2f} "
            f"| {min(machine):.2f} to {max(machine):.2f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--rounds", type=int, default=7)
    chosen = parser.parse_args()
    program = str(Path(chosen.program).resolve())
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        half = place / "half_box.toml"
        half.write_text(half_of(DECK.read_text()))
        rounds = [one_round(program, half, place) for _ in range(chosen.rounds)]
    print("| | one rank | two ranks | efficiency | of each round | half alone | two halves at once | the machine's own | of each round |")
    print("|---|---|---|---|---|---|---|---|---|")
    print(row("whole run", rounds, "wall_seconds"))
    print(row("solving", rounds, "wall_solve"))
    one, two = rounds[-1][0], rounds[-1][1]
    print(f"\nUpdates: one rank {one['contact_updates']:,}, two {two['contact_updates']:,} "
          f"({two['contact_updates'] / one['contact_updates']:.3f} times).")
    print(f"Waiting, mean over ranks and rounds: {statistics.mean(r[1]['wait_seconds_mean'] for r in rounds):.2f} s of "
          f"{statistics.mean(r[1]['wall_seconds'] for r in rounds):.2f} s.")


if __name__ == "__main__":
    main()
