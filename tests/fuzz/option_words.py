"""Options of the command line with numbers and switches: calls, malformed values, and which of them a strict reader takes."""

import re
import subprocess

REAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")
INTEGER = re.compile(r"[+-]?\d+")
MALFORMED = ["", " ", "/", "//", "1/", ",", "1,", ",1", "1,2", "1 2", " 1", "1 ", "2*3", "3*", "1;2", "'1'", '"1"', "1\t2", "\t1", "1\n2", "x",
             "1x", "0x10", "1_000", "1e", "e5", "1e+", "1e5.5", "1.2.3", ".", "+", "-", "+-1", "--1", "1-1", "nan", "NaN", "inf", "-inf",
             "Infinity", "1e999", "-1e999", "99999999999999999999", "-5", "T", ".true.", "(1,2)", "$x", "%s", "é", "１", "9" * 500]  # noqa: RUF001
LETTERS = "0123456789+-.eEdD */,;'\"\t_xinfNaTF()"


def read(word, is_whole, least):
    """The number that a strict reader takes a word for; None where it must refuse it."""
    form = INTEGER if is_whole else REAL
    if len(word) > 40 or not form.fullmatch(word) or not word.isascii() or int(re.split("[eEdD]", word + "e0")[1]) > 200:
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


def list_options(program):
    """Options with numbers (command, name, is it a whole one?) and switches (command, name), as the help texts list them."""
    numbers, switches = [], []
    for command in CALLS:
        said = subprocess.run([program, command, "--help"], capture_output=True, text=True, check=True).stdout
        for name, value in re.findall(r"(?:^ *|[ \[])--([\w-]+)(?: ([A-Za-z|\d.=]+))?(?=  |\]| \[)", said, re.M):
            if value in NUMBERS:
                numbers.append((command, name, NUMBERS[value]))
            elif not value:
                switches.append((command, name))
    return numbers, switches


def call_with(command, name, value):
    """A call that looks at the value of an option and ends before it computes."""
    return [*OTHERS.get((command, name), CALLS[command]), f"--{name}={value}"]


def fault_of_number(option, value, code, said):
    """What is wrong with what the program said to a number; empty where nothing is."""
    _, name, is_whole = option
    is_right = read(value, is_whole, LEAST.get(name, 0)) is not None
    if name == "bandwidth" and is_right and float(re.sub("[dD]", "e", value)) <= 0:
        return ""
    # A walltime of next to nothing is over before the deck is looked for.
    if name == "walltime" and is_right and code == 75:
        return ""
    is_refused = code == 2 and f"option --{name} needs a" in said
    if is_refused == is_right or code not in (0, 2):
        return f"{'refused' if is_refused else 'taken'}, code {code}: {said.strip()[:200]}"
    return ""
