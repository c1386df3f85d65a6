#!/usr/bin/env python3
"""Command lines at random: commands, options, values and files, right and wrong, in any order."""

import re
import subprocess
import sys

from fuzz_harness import Outcome, fuzz, judge, run

VALUES = ["", "0", "1", "-1", "2", "1e9", "2147483647", "99999999999999999999", "nan", "inf", "1e999", "1 2", "2*3", "/", "1,2", "0x10", "x",
          "2.5", "é", "\n", "a" * 5000, "%s%n", "../..", "/dev/null", "/nowhere/file", "deck.toml", "time.steps=3", "time.steps=",
          "=", "..=1", "time.steps=99999999999999999999", "solver.method='nlgs'", "a.b.c=1", "body[0].x=1", "time.steps=1\n[x]",
          "boxes", "graph", "disk", "sphere", "polyhedron", "natural", "coloured", "all", "auto", "2x3", "0x0", "9x9x9x9", "1-3", "3-1"]
FILES = ["deck.toml", "deck.toml", "deck.toml", "nowhere.toml", ".", "", "/dev/null", "/", "box.toml", "problem.hdf5", "DATBOX"]
COMMANDS = ["run", "check", "reference", "convert", "bench", "partition", "solve", "help", "", "rum", "--help", "--version", "-"]
HELP = "splitgrain: nonsmooth"
"""How the help of all commands begins, which a line without a command gets next to exit code 2"""


def prepare(program, _):
    """The options that the help lists."""
    text = "".join(subprocess.run([program, command, "--help"], capture_output=True, text=True, check=True).stdout
                   for command in COMMANDS[:7])
    options = sorted(set(re.findall(r"--[a-z][a-z-]*", text)))
    return options


SMALL = """[time]
step = 1e-3
steps = 2

[[wall]]
from = [-1.0, 0.0]
to = [1.0, 0.0]
thickness = 0.1

[[body]]
shape = "disk"
radius = 0.1
position = [0.0, 0.15]
"""


def make_words(rng, options):
    """A command line."""
    words = [rng.choice(COMMANDS)] if rng.random() < 0.97 else []
    for _ in range(rng.choice([0, 0, 1, 1, 1, 2, 3])):
        words.append(rng.choice(FILES))
    for _ in range(rng.choice([0, 1, 1, 2, 3, 5])):
        option = rng.choice(options)
        if rng.random() < 0.1:
            option = rng.choice(["--", "---", "-x", "--=", "--set=", option + "x", option[:-1], option.upper(), "-" + option])
        at = rng.randrange(len(words) + 1)
        value = rng.choice(VALUES)
        way = rng.randrange(4)
        words[at:at] = [option] if way == 0 else [f"{option}={value}"] if way == 1 else [option, value]
    return [word.replace("\0", "") for word in words]


def try_case(rng, program, place, options):
    """One command line in a folder of its own."""
    (place / "deck.toml").write_text(SMALL)
    words = make_words(rng, options)
    (place / "words.txt").write_text(repr(words))
    ended = run(program, words, place)
    if ended.code == 2 and ended.out.startswith(HELP) and not ended.err:
        return Outcome("refused")
    outcome = judge(ended)
    # Messages repeat words of the command line, which may end a line or a sentence.
    if outcome.word == "wrong" and ended.err.startswith("error: "):
        return Outcome("refused")
    # Measurements take as long as the command line wants.
    if outcome.word == "hung" and ("bench" in words or "--predict" in words):
        return Outcome("clean", "long by wish")
    return outcome


if __name__ == "__main__":
    sys.exit(fuzz("command_lines", __doc__, try_case, prepare))
