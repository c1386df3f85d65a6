#!/usr/bin/env python3
"""Numbers and switches of the command line: what is malformed is refused with the name of its option, what is right is taken.

    fuzz_options.py PROGRAM [--seed N] [--seconds S]

Options and the kind of value that each takes are those of the help texts, so that a new one fails here until it has a call. First
come all options with all malformed words, then random words until the time is over. The calls end before they compute: at a file or
a shape that is not there.
"""

import argparse
import random
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from option_words import MALFORMED, read, word

# Words of the help for a number, and is it a whole one? Options that bound it from below otherwise than by 0, with that bound.
NUMBERS = {"N": True, "CONTACTS": True, "SECONDS": False, "S": False, "X": False, "MU": False, "US": False, "GB": False}
LEAST = {"contacts": 12, "lattice": 12, "sweeps": 1, "check-every": 1, "threads": 1, "parts": 1, "iterations": 1}
# A call of each command that ends soon whatever the number is, and what a number needs to be looked at.
CALLS = {
    "run": ["run", "nowhere.toml"],
    "bench": ["bench", "--shape", "none"],
    "partition": ["partition", "nowhere.toml"],
    "solve": ["solve", "nowhere.hdf5"],
}
OTHERS = {
    ("bench", "threads"): ["bench", "--contacts", "12", "--sweeps", "1", "--order", "natural"],
    ("partition", "lattice"): ["partition", "--shape", "none", "--parts", "2"],
    ("partition", "latency"): ["partition", "tiny.toml", "--parts", "1", "--predict"],
    ("partition", "bandwidth"): ["partition", "tiny.toml", "--parts", "1", "--predict"],
}
TINY = """[time]
step = 1e-3
steps = 1
[[material]]
name = "stone"
density = 1.0
[[law]]
[[body]]
shape = "disk"
radius = 1.0
"""


class Options:
    """The options of a program, and what it says to words."""

    def __init__(self, program, place):
        self.program, self.place, self.faults, self.calls = program, Path(place), [], 0
        (self.place / "tiny.toml").write_text(TINY)
        self.numbers, self.switches = [], []
        for command in CALLS:
            said = subprocess.run([program, command, "--help"], capture_output=True, text=True, check=True).stdout
            for name, value in re.findall(r"(?:^ *|[ \[])--([\w-]+)(?: ([A-Za-z|\d.=]+))?(?=  |\]| \[)", said, re.M):
                if value in NUMBERS:
                    self.numbers.append((command, name, NUMBERS[value]))
                elif not value:
                    self.switches.append((command, name))

    def say(self, call):
        """What a call prints as its error, and its exit code."""
        self.calls += 1
        done = subprocess.run([self.program, *call], cwd=self.place, capture_output=True, text=True, timeout=60)
        return done.returncode, done.stderr

    def number(self, command, name, is_whole, value):
        """One number: refused by name, or taken."""
        call = [*OTHERS.get((command, name), CALLS[command]), f"--{name}={value}"]
        code, said = self.say(call)
        is_right = read(value, is_whole, LEAST.get(name, 0)) is not None
        if name == "bandwidth" and is_right and float(re.sub("[dD]", "e", value)) <= 0:
            return
        is_refused = code == 2 and f"option --{name} needs a" in said
        if is_refused == is_right or code not in (0, 2):
            self.faults.append(f"{call}: {'refused' if is_refused else 'taken'}, code {code}: {said.strip()[:200]}")

    def switch(self, command, name, value):
        """A switch with a value: refused by name."""
        call = [*CALLS[command], f"--{name}={value}"]
        code, said = self.say(call)
        if code != 2 or f"option --{name} takes no value" not in said:
            self.faults.append(f"{call}: code {code}: {said.strip()[:200]}")


def main():
    """All options with all malformed words, then random ones."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=5)
    chosen = parser.parse_args()
    rng = random.Random(chosen.seed)
    end = time.monotonic() + chosen.seconds
    with tempfile.TemporaryDirectory(prefix="options ") as place:
        options = Options(str(Path(chosen.program).resolve()), place)
        expected = {("run", "walltime"), ("bench", "contacts"), ("partition", "parts"), ("solve", "tolerance")}
        if not expected <= {option[:2] for option in options.numbers} or ("run", "quiet") not in options.switches:
            options.faults.append(f"the help no longer shows its options as this test reads them: {options.numbers}, {options.switches}")
        for option in options.numbers:
            for value in MALFORMED:
                options.number(*option, value)
            options.number(*option, "12")
        for command, name in options.switches:
            for value in ("1", "yes", "true", "/"):
                options.switch(command, name, value)
        while time.monotonic() < end and options.numbers:
            options.number(*rng.choice(options.numbers), word(rng))
    for fault in options.faults[:20]:
        print(fault)
    print(f"seed {chosen.seed}: {options.calls} calls, {len(options.numbers)} numbers, {len(options.switches)} switches; "
          f"{options.calls - len(options.faults)} passed, {len(options.faults)} failed")
    return 1 if options.faults else 0


if __name__ == "__main__":
    sys.exit(main())
