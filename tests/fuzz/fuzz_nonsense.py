#!/usr/bin/env python3
"""Keys of decks with values that they must refuse, one at a time: refused with the name of the key."""

import sys

from fuzz_harness import Outcome, fuzz, judge, run
from nonsense import base, read_reference, spoilt


def prepare(program, _):
    """Paths and keys of the decks of both dimensions."""
    keys = {}
    for dimension in (2, 3):
        text = base(dimension)
        keys[dimension] = [(f"{heading.strip('[]')}.{key.name}", key) for heading, list_of_keys in read_reference(program).items()
                           if heading in text for key in list_of_keys]
    return keys


def try_case(rng, program, place, keys):
    """One value of one key."""
    dimension = rng.choice((2, 3))
    path, key = rng.choice(keys[dimension])
    value = rng.choice(spoilt(key, dimension))
    (place / "deck.toml").write_text(base(dimension))
    (place / "words.txt").write_text(f"check deck.toml --set {path}={value}")
    ended = run(program, ["check", "deck.toml", "--set", f"{path}={value}"], place)
    outcome = judge(ended)
    if outcome.word in ("clean", "refused") and (ended.code != 2 or key.name not in ended.err):
        return Outcome("wrong", f"{path} = {value} in {dimension}D: exit code {ended.code}, {ended.err.strip()[:200]}")
    return outcome


if __name__ == "__main__":
    sys.exit(fuzz("nonsense", __doc__, try_case, prepare))
