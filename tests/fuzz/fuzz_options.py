#!/usr/bin/env python3
"""Numbers of the command line at random: what is malformed is refused with the name of its option, what is right is taken."""

import sys

from fuzz_harness import Outcome, fuzz, judge, run
from option_words import TINY, call_with, fault_of_number, list_options, word


def prepare(program, _):
    """The options that the help lists."""
    return list_options(program)[0]


def try_case(rng, program, place, numbers):
    """One number for one option."""
    (place / "tiny.toml").write_text(TINY)
    option, value = rng.choice(numbers), word(rng)
    call = call_with(*option[:2], value)
    (place / "words.txt").write_text(repr(call))
    ended = run(program, call, place)
    fault = fault_of_number(option, value, ended.code, ended.err)
    return Outcome("wrong", f"{call}: {fault}") if fault else judge(ended)


if __name__ == "__main__":
    sys.exit(fuzz("options", __doc__, try_case, prepare))
