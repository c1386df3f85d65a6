"""Values of command-line options, right and malformed, and what a strict reader must say to them."""

import re

REAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")
INTEGER = re.compile(r"[+-]?\d+")
MALFORMED = ["", " ", "/", "//", "1/", ",", "1,", ",1", "1,2", "1 2", " 1", "1 ", "2*3", "3*", "1;2", "'1'", '"1"', "1\t2", "\t1", "1\n2", "x",
             "1x", "0x10", "1_000", "1e", "e5", "1e+", "1e5.5", "1.2.3", ".", "+", "-", "+-1", "--1", "1-1", "nan", "NaN", "inf", "-inf",
             "Infinity", "1e999", "-1e999", "99999999999999999999", "-5", "T", ".true.", "(1,2)", "$x", "%s", "é", "１", "9" * 500]  # noqa: RUF001
LETTERS = "0123456789+-.eEdD */,;'\"\t_xinfNaTF()"


def read(word, is_whole, least):
    """The number that a strict reader takes a word for; None where it must refuse it."""
    form = INTEGER if is_whole else REAL
    if len(word) > 40 or not form.fullmatch(word) or not word.isascii():
        return None
    value = float(re.sub("[dD]", "e", word))
    return value if least <= value <= 2147483647 else None


def word(rng):
    """A random word that looks like a number, more or less."""
    if rng.random() < 0.3:
        return rng.choice(MALFORMED)
    if rng.random() < 0.4:
        text = rng.choice([str(rng.randint(-3, 3000)), repr(rng.uniform(-10, 3e9)), f"{rng.uniform(0, 10):.3e}", f".{rng.randint(0, 99)}"])
        at = rng.randrange(len(text) + 1)
        return text if rng.random() < 0.5 else text[:at] + rng.choice(LETTERS) + text[at:]
    return "".join(rng.choice(LETTERS) for _ in range(rng.randint(1, 8)))
