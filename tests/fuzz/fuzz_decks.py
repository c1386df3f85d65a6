#!/usr/bin/env python3
"""Decks at random, decks of input_decks spoilt, and decks of input_decks written in another way that must give the same answer.

Decks at random are those of tests/stiff/random_decks.py. What is written in another way: comments, blanks, order of keys, line
ends, spelling of numbers and of keys. A run whose steps all count as converged must have recorded no error above its tolerance.
"""

import json
import re
import sys
from pathlib import Path

from fuzz_harness import SOURCE, Outcome, fuzz, judge, run, worst

import random_decks
from judged_runs import TOO_LONG, Runner
from reference_keys import read_reference
from spoilt_decks import spoil

# Numbers of record.csv and run.json that no two runs share.
COSTS = re.compile(r"cpu|wall|seconds|memory|bytes|time_|updates_per|hash|reason|deck|date|host|version|files?\b")
STEPS = 3


def prepare(program, folder):
    """Sections of the reference, and the decks of the project, cut to a few steps, that run alone."""
    decks = []
    for path in sorted((SOURCE / "input_decks").glob("*.toml")) + sorted((SOURCE / "tests/decks").glob("*/deck.toml")):
        text = path.read_text()
        if re.search(r"^\s*(file|datbox)\s*=", text, re.M):
            continue
        short = re.sub(r"^(\s*steps\s*=\s*).*", rf"\g<1>{STEPS}", text, flags=re.M)
        (folder / "deck.toml").write_text(short)
        ended = run(program, ["run", "deck.toml", "--output", f"{path.parent.name}_{path.stem}", "--quiet"], folder)
        if ended.code == 0:
            decks.append(short)
    return read_reference(program), decks


def try_case(rng, program, place, material):
    """One deck of one of three kinds."""
    sections, decks = material
    kind = rng.randrange(3)
    if kind == 0:
        return try_random(rng, program, place, sections)
    if kind == 1:
        return try_spoilt(rng, program, place, rng.choice(decks))
    return try_rewritten(rng, program, place, rng.choice(decks))


def try_spoilt(rng, program, place, text):
    """A spoilt deck, run twice in memory that holds other bytes where nothing was set: what is printed must be the same."""
    if rng.random() < 0.3:
        text += '\n[[drive]]\nbody = 1\ncomponent = "x"\nfile = "table.txt"\n'
        table = [f"{i} {rng.choice([i, 1e-3, -2.5])}" for i in range(rng.choice([0, 1, 2, 9]))]
        (place / "table.txt").write_bytes(spoil(rng, table) if table else b"")
        (place / "deck.toml").write_text(text)
    else:
        (place / "deck.toml").write_bytes(spoil(rng, text.split("\n")))
    first, second = (run(program, ["run", "deck.toml", "--output", "results", "--quiet"], place, environment={"MALLOC_PERTURB_": fill})
                     for fill in ("85", "181"))
    outcomes = [judge(first, place), judge(second, place), check_verdict(place / "results", first.code)]
    if (first.code, first.err) != (second.code, second.err):
        outcomes.append(Outcome("wrong", f"values that were never set: {first.err[:200]!r}, then {second.err[:200]!r}"))
    return worst(outcomes)


def try_random(rng, program, place, sections):
    """A deck of tests/stiff/random_decks.py, and its judgement as an outcome."""
    _, code, fault = random_decks.one(rng.getrandbits(48), 0, sections, Runner(program, None, 0), place)
    if fault:
        return Outcome("crashed" if re.match("the run-time checks|exit code -?[0-9]+$", fault) else "wrong", fault)
    if code in TOO_LONG:
        # Random counts make long runs, which are right: random_decks.py limits their share.
        return Outcome("clean", "cut short")
    return worst([Outcome("refused" if code in (2, 5) else "clean"), check_verdict(place / "results", code)])


def check_verdict(folder, code):
    """Wrong where a run ends well with all steps converged next to a recorded error above its tolerance."""
    if code != 0 or not (folder / "run.json").exists():
        return Outcome("clean")
    summary = json.loads((folder / "run.json").read_text())
    criterion, tolerance = summary["criterion"], summary["tolerance"]
    largest = summary.get(f"worst_{criterion}")
    if summary["unconverged_steps"] == 0 and largest is not None and largest > tolerance * (1 + 1e-9):
        return Outcome("wrong", f"converged in all steps to {criterion} <= {tolerance}, but the worst is {largest}")
    return Outcome("clean")


def try_rewritten(rng, program, place, text):
    """The same deck in another spelling: the answer must be the same, bit for bit."""
    (place / "deck.toml").write_text(text)
    first = run(program, ["run", "deck.toml", "--output", "first", "--quiet"], place)
    (place / "other.toml").write_bytes(rewrite(rng, text))
    second = run(program, ["run", "other.toml", "--output", "second", "--quiet"], place)
    outcome = worst([judge(first, place, "first"), judge(second, place, "second")])
    if outcome.word == "clean" and first.code != second.code:
        return Outcome("wrong", f"exit code {first.code}, in another spelling {second.code}")
    if 2 in (first.code, second.code):
        return Outcome("wrong", f"a deck of the project is refused in another spelling: {outcome.why}")
    different = compare(place / "first", place / "second") if outcome.word == "clean" else ""
    return Outcome("wrong", different) if different else outcome


def rewrite(rng, text):
    """The same deck in another spelling."""
    blocks = re.split(r"^(?=\[)", text, flags=re.M)
    if rng.random() < 0.7:
        blocks = [shuffle_keys(rng, block) for block in blocks]
    lines = "".join(blocks).split("\n")
    for at in range(len(lines) - 1, -1, -1):
        if rng.random() < 0.2 and is_plain(lines[at]):
            lines[at] += rng.choice(["  # said = again [", "\t", "   ", " #", ' # """'])
        if rng.random() < 0.2 and is_plain(lines[at]):
            lines[at] = rng.choice(["  ", "\t"]) + lines[at]
        if rng.random() < 0.2 and is_plain(lines[at]):
            lines[at] = re.sub(r"^(\s*)(\w+)(\s*)=", rng.choice([r'\1"\2"=', r"\1'\2' =", r"\1\2\t=  "]), lines[at])
        if rng.random() < 0.3 and is_plain(lines[at]):
            lines[at] = re.sub(r"(?<![\w.\"+-])(\d+\.\d+)(?![\w.\"])", lambda found: spell(rng, found[1]), lines[at])
    end = rng.choice(["\n", "\n", "\r\n"])
    return (rng.choice(["", "", "\ufeff"]) + end.join(lines)).encode("utf8")


def is_plain(line):
    """Is it a whole statement of one line: a heading or a key with its value, no text in it?"""
    return re.fullmatch(r"\s*(\[+[\w.]+\]+|\w+\s*=\s*(true|false|[-+\d.e_]+|\[[-+\d.e, ]*\]))\s*", line) is not None


def shuffle_keys(rng, block):
    """Keys of a block in another order, where all of them are plain."""
    head, *lines = block.split("\n")
    body = [line for line in lines if line.strip() and not line.strip().startswith("#")]
    if not head.startswith("[") or not all(is_plain(line) or re.fullmatch(r'\w+ = "[^"\\]*"', line) for line in body):
        return block
    rng.shuffle(body)
    return "\n".join([head, *body, "", ""])


def spell(rng, number):
    """The same double in other letters."""
    whole, part = number.split(".")
    ways = [number + "0", "+" + number, number + "e0", number + "E+00", f"{whole}{part}e-{len(part)}" if whole != "0" else number]
    chosen = rng.choice(ways)
    return chosen if float(chosen) == float(number) else number


def compare(first, second):
    """The first number in which two folders of results differ, those of cost left out."""
    left, right = (rows((folder / "record.csv").read_text()) for folder in (first, second))
    if len(left) != len(right):
        return f"{len(left)} and {len(right)} rows"
    for one, other in zip(left, right):
        for name, value in one.items():
            if not COSTS.search(name) and value != other.get(name):
                return f"{name} is {value}, in another spelling {other.get(name)}"
    return ""


def rows(text):
    """Rows of a record as dictionaries."""
    head, *lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    return [dict(zip(head.split(","), line.split(","))) for line in lines]


if __name__ == "__main__":
    sys.exit(fuzz("decks", __doc__, try_case, prepare))
