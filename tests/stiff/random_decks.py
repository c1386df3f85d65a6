#!/usr/bin/env python3
"""Random decks: small scenes, right and wrong, that the program must run or refuse, but never break on.

    random_decks.py PROGRAM [--seed N] [--seconds S] [--only I] [--ranks MPIEXEC] [--keep FOLDER]

Sections, keys, kinds of value and ranges are those of `splitgrain reference`, so that keys that are new are met without a
change here; places, shapes and sizes come from here, since bodies must not overlap. One deck in three is right as far as its
keys go, one in three is spoilt as text, one in nine is a DATBOX, half of those spoilt. Deck I of seed N is always the same:
`--only I` repeats it alone.

A deck fails when the exit code is none of those documented, or a signal; when a sanitizer or the run-time checks speak; when a
number that is not finite stands in run.json or record.csv; when what is refused is not told by one sentence with its file; or
when a right deck takes more CPU time than it should. The folder of a deck that fails is kept.
"""

import argparse
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

CODES = {0: "ran", 2: "refused", 3: "not converged", 4: "stopped for a value that is not finite", 5: "could not write", 6: "unbalanced", 75: "stopped early"}
ALARMS = re.compile(r"Sanitizer|runtime error:|Fortran runtime|Backtrace for|SIG[A-Z]{3,}|internal error|forrtl", re.I)
SENTENCE = re.compile(r"^(?:[^\n]*?: )?error: \S.*[^.\s]$", re.M)
CPU_LIMIT = 60
TOO_LONG = {-signal.SIGXCPU: "cut short", -signal.SIGKILL: "cut short"}
# Share of decks that may be cut short: more are a program that does not end.
MOST_CUT = 0.02
PICKED = {"steps", "step", "maximum_sweeps", "threads", "dimension", "datbox", "file", "faces", "scale", "hull", "every", "seed"}


class Key:
    """One line of the reference."""

    def __init__(self, name, value, default, meaning):
        self.name, self.value, self.default, self.meaning = name, value, default, meaning

    def fits(self, dimension, block):
        """Does it apply in a scene and to a block?"""
        if "Only in space" in self.meaning and dimension == 2 or "Only in the plane" in self.meaning and dimension == 3:
            return False
        only = re.search(r"Only for (\w+) ((?:`[^`]*`(?:, )?)+)", self.meaning)
        return not only or block.get(only[1], '""').strip('"') in re.findall(r"`([^`]*)`", only[2])

    def text(self, rng, dimension, spread):
        """A value as TOML; nothing where only a person knows one."""
        kind = self.value
        if ", in space " in kind or "; in space " in kind:
            halves = re.split(r"[,;] in space ", kind)
            bounds = re.search(r", (?:at|above).*", halves[1])
            kind = halves[1] if dimension == 3 else halves[0] + (bounds[0] if bounds else "")
        low, high = self.bound(kind, r"(?:at least|above)"), self.bound(kind, "at most")
        if kind.startswith("`"):
            return f'"{rng.choice(re.findall(r"`([^`]*)`", kind))}"'
        if kind == "true or false":
            return rng.choice(["true", "false"])
        if kind.startswith("an integer"):
            return str(rng.randint(int(max(low, -5)), int(min(high, max(low, 0) + 6))))
        if kind.startswith("a number") and "list" not in kind:
            return number(draw(rng, low, high, spread))
        count = re.match(r"a list of (\d) numbers", kind)
        if count:
            return "[" + ", ".join(number(draw(rng, low, high, spread)) for _ in range(int(count[1]))) + "]"
        return None

    @staticmethod
    def bound(kind, word):
        """A bound of the range."""
        found = re.search(word + r" ([-+.\de]+)", kind)
        if found:
            return float(found[1].rstrip("."))
        return math.inf if "most" in word else -math.inf


def number(value):
    """A real as TOML."""
    text = repr(float(value))
    return text if re.search(r"[.e]", text) else text + ".0"


def draw(rng, low, high, spread):
    """A number of any size within a range, its ends at times."""
    if math.isfinite(low) and rng.random() < 0.1:
        return low
    if math.isfinite(high) and rng.random() < 0.1:
        return high
    value = 10 ** rng.uniform(-spread, spread)
    if low >= 0:
        return min(max(value, low * (1 + 1e-9)), high)
    return max(low, min(high, rng.choice([-1, 1]) * value))


def read_reference(program):
    """Sections and their keys."""
    sections = {}
    text = subprocess.run([program, "reference"], capture_output=True, text=True, check=True).stdout
    for block in re.split(r"^## ", text, flags=re.M)[1:]:
        heading = re.match(r"`(\[+[\w.]+\]+)`", block)[1]
        rows = re.findall(r"^\| `(\w+)` \| (.*?) \| .*? \| (.*?) \| (.*?) \|$", block, re.M)
        sections[heading] = [Key(*row) for row in rows]
    return sections


class Scene:
    """A deck that is right, as a list of blocks."""

    def __init__(self, rng, sections):
        self.rng, self.sections, self.blocks = rng, sections, []
        self.dimension = rng.choice([2, 3])
        self.length = 10 ** rng.choice([0, 0, 0, rng.uniform(-6, 6)])
        self.wild = rng.random() < 0.3
        self.spread = 12 if self.wild else 1.5
        self.names = []
        self.make()

    def chance(self, share):
        return self.rng.random() < share

    def add(self, heading, **values):
        """Add a block, with some more keys of its section at random."""
        block = {name: value if isinstance(value, str) else self.say(value) for name, value in values.items()}
        for key in self.sections.get(heading, []):
            if key.name in block or key.name in PICKED or not self.chance(0.06 if heading.startswith("[[") else 0.15):
                continue
            if key.name in ("name", "colour", "material", "law", "body", "between", "candidate", "antagonist", "position", "box",
                            "size", "thickness", "corner", "centre", "radius", "pressure", "direction", "structure_box"):
                continue
            if key.fits(self.dimension, block):
                text = key.text(self.rng, self.dimension, self.spread)
                if text:
                    block[key.name] = text
        self.blocks.append((heading, block))

    def say(self, value):
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, (list, tuple)):
            return "[" + ", ".join(self.say(item) for item in value) + "]"
        return str(value) if isinstance(value, int) else number(value)

    def quote(self, word):
        return f'"{word}"'

    def make(self):
        rng, d = self.rng, self.dimension
        self.cell = self.length
        self.columns = rng.randint(1, 4)
        scene = {"dimension": d} if d == 3 or self.chance(0.3) else {}
        self.period = (self.columns + 1) * self.cell if self.chance(0.25) else 0.0
        if self.period:
            scene["period_x"] = self.period
        if self.chance(0.3):
            scene["gravity"] = [draw(rng, -math.inf, math.inf, self.spread) * self.length for _ in range(d)]
        if scene or self.chance(0.5):
            self.add("[scene]", **scene)
        step = 10 ** rng.choice([-3.0, rng.uniform(-6, 0)]) * self.length**0.5
        self.add("[time]", step=step, steps=rng.choice([0, 1, 2, 3, 6]))
        self.add("[solver]", maximum_sweeps=rng.choice([1, 5, 40]))
        for heading in self.sections:
            if heading not in ("[scene]", "[time]", "[solver]") and not heading.startswith("[[") and self.chance(0.4):
                self.add(heading)
        materials = rng.randint(1, 2)
        for i in range(materials):
            self.add("[[material]]", name=self.quote(f"m{i}"), density=10 ** rng.uniform(-3, 4))
        self.material = {"material": self.quote("m0")} if materials > 1 else {}
        self.make_bodies()
        self.make_walls()
        self.make_sample()
        self.make_laws()
        self.make_drives()

    def make_laws(self):
        kinds = re.findall(r"`([^`]*)`", next(key for key in self.sections["[[law]]"] if key.name == "kind").value)
        n = self.rng.choice([0, 1, 1, 1, 2])
        for i in range(n):
            kind = self.rng.choice(kinds) if self.chance(0.5) else "IQS_CLB"
            needs = {"IQS_WET_DS_CLB": {"wet_thickness": 0.01 * self.cell}, "LINEAR": {"epsilon": 10 ** self.rng.uniform(-6, 2)},
                     "ELASTIC_REPELL_CLB": {"stiffness": 10 ** self.rng.uniform(2, 8)}}
            more = dict(needs.get(kind, {}))
            if kind != "LINEAR" and self.chance(0.8):
                more["friction"] = self.rng.choice([0.0, 0.3, 1.0, 10.0, 100.0, 1e-8])
            self.add("[[law]]", name=self.quote(f"law{i}"), kind=self.quote(kind), **more)
        for i in range(n if n > 1 or n and self.chance(0.3) else 0):
            self.add("[[interaction]]", law=self.quote(f"law{i}"))

    def shape(self, size):
        """A shape within a sphere of a radius, as keys."""
        rng = self.rng
        thin = size * 10 ** rng.choice([-0.5, rng.uniform(-6, -0.3) if self.wild else -0.4])
        if self.dimension == 2:
            kind = rng.choice(["disk", "disk", "segment", "polygon"])
            if kind == "polygon":
                n = rng.randint(3, 8)
                turn = rng.uniform(0, 7)
                points = [[size * math.cos(turn + 2 * math.pi * i / n), size * math.sin(turn + 2 * math.pi * i / n)] for i in range(n)]
                return kind, {"vertices": points}
            return kind, {"radius": size} if kind == "disk" else {"half_length": size - thin, "half_thickness": thin}
        kind = rng.choice(["sphere", "sphere", "box", "cylinder", "polyhedron"])
        if kind == "sphere":
            return kind, {"radius": size}
        if kind == "box":
            return kind, {"half_axes": [size / 1.8, size / 1.8, min(thin, size / 1.8)]}
        if kind == "cylinder":
            return kind, {"half_height": size - thin, "radius": thin}
        return kind, {"vertices": [[size, 0, 0], [-size, 0, 0], [0, size, 0], [0, -size, 0], [0, 0, size], [0, 0, -thin]]}

    def make_bodies(self):
        rng, d = self.rng, self.dimension
        for i in range(rng.randint(0, 10)):
            place = [(i % self.columns + 0.55) * self.cell, (i // self.columns + 0.55) * self.cell]
            if d == 3:
                place.insert(1, 0.55 * self.cell)
            size = self.cell / 2 * rng.choice([1.0, rng.uniform(0.1, 1.0), 10 ** rng.uniform(-4, 0) if self.wild else 0.9])
            more = dict(self.material)
            if self.chance(0.3):
                self.names.append(f"b{i}")
                more["name"] = self.quote(f"b{i}")
            if self.chance(0.2):
                more["velocity"] = [draw(rng, -math.inf, math.inf, self.spread) * self.length for _ in range(d)]
            if self.chance(0.2):
                more["spin"] = draw(rng, -math.inf, math.inf, self.spread) if d == 2 else [rng.uniform(-9, 9) for _ in range(3)]
            if self.chance(0.1):
                more["fixed"] = True
            if self.wild and self.chance(0.3):
                more["mass"] = 10 ** rng.uniform(-9, 9)
            if self.chance(0.2):
                self.add("[[body]]", position=place, **more)
                for _ in range(rng.randint(1, 3)):
                    kind, sizes = self.shape(size / 2)
                    self.add("[[body.shape]]", kind=self.quote(kind), centre=[rng.uniform(-0.5, 0.5) * size for _ in range(d)], **sizes)
            else:
                kind, sizes = self.shape(size)
                self.add("[[body]]", position=place, shape=self.quote(kind), **sizes, **more)

    def make_walls(self):
        if self.chance(0.2):
            return
        width = 40 * self.cell
        self.names.append("floor")
        if self.dimension == 2:
            self.add("[[wall]]", name='"floor"', **{"from": [-width, -0.2 * self.cell], "to": [width, -0.2 * self.cell]},
                     thickness=0.4 * self.cell, **self.material)
            if self.chance(0.3):
                self.names.append("lid")
                top = 20 * self.cell
                self.add("[[wall]]", name='"lid"', **{"from": [0.0, top], "to": [self.cell * 4, top]}, thickness=0.4 * self.cell,
                         pressure=10 ** self.rng.uniform(0, 5), direction=[0, -1], **self.material)
        elif self.period or self.chance(0.5):
            self.add("[[wall]]", name='"floor"', centre=[0.0, 0.0, 0.0], size=[width, width], thickness=self.cell, **self.material)
        else:
            self.names.append("box.floor")
            self.names.remove("floor")
            self.add("[[container]]", size=[(self.columns + 1) * self.cell, 1.2 * self.cell, 30 * self.cell], **self.material)

    def make_sample(self):
        if not self.chance(0.35):
            return
        d, cell = self.dimension, self.cell
        low = [0.0, 12 * cell] if d == 2 else [0.0, 0.05 * cell, 12 * cell]
        high = [(self.columns + 1) * cell, 15 * cell] if d == 2 else [(self.columns + 1) * cell, 1.15 * cell, 15 * cell]
        shape = self.rng.choice(["disk", "polygon"] if d == 2 else ["sphere", "polyhedron"])
        lattice = self.chance(0.5)
        more = {"kind": self.quote("lattice")} if lattice else {"count": self.rng.randint(1, 8)}
        self.add("[[sample]]", box=low + high, radius=[0.15 * cell, 0.25 * cell], shape=self.quote(shape), **more, **self.material)

    def make_drives(self):
        axes = ["x", "y", "rotation"] if self.dimension == 2 else ["x", "y", "z", "rotation_x", "rotation_y", "rotation_z"]
        for _ in range(self.rng.choice([0, 0, 1, 2])):
            if self.names:
                self.add("[[drive]]", body=self.quote(self.rng.choice(self.names)), component=self.quote(self.rng.choice(axes)),
                         value=draw(self.rng, -math.inf, math.inf, self.spread))

    def lines(self):
        """The deck as lines."""
        for heading, block in self.blocks:
            yield heading
            for name, value in block.items():
                yield f"{name} = {value}"


VALUES = ["nan", "inf", "-inf", "+nan", "1e999", "-1e300", "1e300", "1e-300", "-1", "0", "-0.0", "1e18", "9223372036854775807",
          "99999999999999999999", "2147483648", '""', '"x"', "[]", "[[]]", "[1, 2]", '["a", 1]', "true", "{}", "{a = 1}", "[nan, 0]",
          "1979-05-27", "0x1F", "1_000", "'''", '"\\u0000"', '"\\uD800"', "é", "[[1, 2], [3]]", "NaN", "1.", ".5", "1d3"]
GROWING = re.compile(r"^(radius|box|count|fill|rows|columns|voussoirs|steps|maximum_sweeps|threads|sides|vertices|spacing|size|"
                     r"position|period_.|trace_steps|half_\w+|from|to|structure_box)\b")


def spoil(rng, lines):
    """A deck spoilt as text, as bytes."""
    lines = list(lines)
    for _ in range(rng.randint(1, 3)):
        at = rng.randrange(len(lines))
        way = rng.randrange(12)
        if way <= 3 and "=" in lines[at] and not GROWING.match(lines[at]):
            lines[at] = lines[at].split("=")[0] + "= " + rng.choice(VALUES)
        elif way <= 3 and "=" in lines[at]:
            lines[at] = lines[at].split("=")[0] + "= " + rng.choice([value for value in VALUES if not re.match(r"\d|1_|0x|-?1e-", value)])
        elif way == 4:
            del lines[at]
        elif way == 5:
            lines.insert(at, lines[at])
        elif way == 6:
            lines.insert(at, rng.choice(["[[nowhere]]", "[time]", "[[body]]", "[[body.shape]]", "[[drive]]", "[[wall]]", "[body]",
                                         "colour = 3", "a.b.c = 1", "= 1", "[", "]]", "# \x00\x01", "[[sample]]", "[[pressure]]"]))
        elif way == 7:
            letters = list(lines[at])
            letters[rng.randrange(len(letters))] = rng.choice("abcxyz_=[]\"'#{}.,0 9-")
            lines[at] = "".join(letters)
        elif way == 8:
            other = rng.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        elif way == 9:
            lines[at] = lines[at][: rng.randrange(len(lines[at]) + 1)]
        elif way == 10:
            lines[at] = lines[at] + " " * rng.choice([1, 300, 70000]) + rng.choice(["", "#", "x"])
        if not lines:
            lines = [""]
    return spoil_bytes(rng, ("\n".join(lines) + "\n").encode("utf8", "surrogatepass"), 0.25)


def spoil_bytes(rng, data, share):
    """Bytes cut off, changed, or put in."""
    if rng.random() > share or not data:
        return data
    at = rng.randrange(len(data))
    way = rng.randrange(5)
    if way == 0:
        return data[:at]
    if way == 1:
        return data[:at] + bytes(rng.randrange(256) for _ in range(rng.randint(1, 40))) + data[at:]
    if way == 2:
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1:]
    if way == 3:
        return b"\xef\xbb\xbf" + data.replace(b"\n", b"\r\n")
    return bytes(rng.randrange(256) for _ in range(rng.randint(0, 400)))


def spoil_datbox(rng, folder):
    """One or two files of a DATBOX spoilt."""
    files = sorted(path for path in folder.iterdir() if path.stat().st_size > 0)
    for _ in range(rng.randint(1, 2)):
        path = rng.choice(files)
        if not path.exists():
            continue
        if rng.random() < 0.1:
            path.unlink()
            continue
        lines = path.read_bytes().decode("latin1").split("\n")
        for _ in range(rng.randint(1, 4)):
            at = rng.randrange(len(lines))
            line = lines[at]
            way = rng.randrange(7)
            numbers = list(re.finditer(r"[-+ ]\d\.\d{7}D[-+]\d\d", line))
            if way <= 2 and numbers:
                one = rng.choice(numbers)
                new = rng.choice(["           NaN", "      Infinity", "-1.0000000D+00", " 0.0000000D+00", " 1.0000000D+60", " 1.0000000D-60",
                                  " 1.0000000D+99", "              ", " 1.00e00000000", "\t", " 1.0000000E-310"])
                lines[at] = line[: one.start()] + new + line[one.end():]
            elif way == 3:
                lines[at] = re.sub(r"\d+", lambda _: rng.choice(["0", "-1", "99999999", "7"]), line, count=1)
            elif way == 4:
                del lines[at]
                lines = lines or [""]
            elif way == 5:
                lines.insert(at, line)
            else:
                lines[at] = line[: rng.randrange(len(line) + 1)]
        path.write_bytes(spoil_bytes(rng, "\n".join(lines).encode("latin1"), 0.2))


class Runner:
    """Runs decks and judges them."""

    def __init__(self, program, launcher):
        self.program, self.launcher = program, launcher

    def call(self, words, place, ranks=1):
        """Run the program within limits; output to files, since it may be long."""
        command = [self.program, *words]
        if ranks > 1:
            command = [self.launcher, "--oversubscribe", "-n", str(ranks), *command]
        with open(place / "out.txt", "wb") as out, open(place / "err.txt", "wb") as err:
            try:
                done = subprocess.run(command, cwd=place, stdout=out, stderr=err, timeout=20 * CPU_LIMIT, check=False,
                                      preexec_fn=limit)
                return done.returncode
            except subprocess.TimeoutExpired:
                return -signal.SIGXCPU

    def judge(self, place, code, results="results"):
        """What is wrong with a run; nothing when all is well."""
        said = (place / "err.txt").read_bytes().decode("utf8", "replace")
        alarm = ALARMS.search(said)
        # Random counts make long runs, in builds with checks ten times as long: what was cut short is counted, and judged together.
        if code in TOO_LONG and (not alarm or alarm.group().startswith("SIG")):
            return None
        if alarm:
            return f"the run-time checks speak: {said[alarm.start():alarm.start() + 200].splitlines()[0]}"
        if code not in CODES:
            return f"exit code {code}"
        if code in (2, 4, 5) and not SENTENCE.search(said):
            return f"exit code {code} without a sentence that tells why"
        if code == 2 and not any(re.match(r"(\S.*?)(:\d+)*: error: ", line) for line in said.splitlines()):
            return "a mistake without its file"
        return self.judge_results(place / results, code)

    @staticmethod
    def judge_results(folder, code):
        """Numbers that are not finite in what was written."""
        summary = folder / "run.json"
        if code == 0 and not summary.exists():
            return "no run.json"
        if summary.exists():
            try:
                json.loads(summary.read_text(encoding="utf8"), parse_constant=complain)
            except ValueError as error:
                return f"run.json: {error}"
        record = folder / "record.csv"
        if record.exists() and re.search(r"(?:^|,)\s*[-+]?(?:nan|inf)", record.read_text(), re.I | re.M):
            return "a number that is not finite in record.csv"
        return None


def complain(word):
    raise ValueError(f"holds {word}")


def limit():
    """Limits of a run: its time, and no core file."""
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_LIMIT, CPU_LIMIT + 5))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def make(rng, sections, runner, place):
    """Write the deck of one number: its kind, and is it right?"""
    scene = Scene(rng, sections)
    kind = rng.randrange(9)
    text = ("\n".join(scene.lines()) + "\n").encode("utf8")
    deck = place / "deck.toml"
    if kind < 4 or kind == 8:
        deck.write_bytes(text)
        if kind < 4:
            return "right", True
        code = runner.call(["convert", "deck.toml", "DATBOX"], place)
        box = place / "DATBOX"
        if code != 0 or not box.is_dir():
            return "right", True
        is_spoilt = rng.random() < 0.7
        if is_spoilt:
            spoil_datbox(rng, box)
        dimension = f"dimension = {scene.dimension}\n"
        deck.write_text(f'[scene]\n{dimension}datbox = "DATBOX"\n[time]\nstep = 1e-4\nsteps = 3\n[solver]\nmaximum_sweeps = 40\n')
        return "DATBOX", not is_spoilt
    deck.write_bytes(spoil(rng, scene.lines()))
    return "spoilt", False


def one(seed, index, sections, runner, place):
    """Make and run one deck; its kind, exit code, and what is wrong."""
    rng = random.Random(f"{seed}:{index}")
    kind, _ = make(rng, sections, runner, place)
    ranks = rng.choice([2, 3]) if runner.launcher and rng.random() < 0.3 else 1
    code = runner.call(["run", "deck.toml", "--output", "results", "--quiet"], place, ranks)
    return kind + (f" on {ranks} ranks" if ranks > 1 else ""), code, runner.judge(place, code)


def cpu():
    """CPU seconds of all programs run."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main():
    """Run decks until the time is over."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60, help="CPU seconds of all runs together")
    parser.add_argument("--decks", type=int, default=1000000, help="decks at most")
    parser.add_argument("--only", type=int, help="run this deck alone, and keep it")
    parser.add_argument("--ranks", metavar="MPIEXEC", help="run some decks on several ranks")
    parser.add_argument("--keep", default=".", help="folder for those that fail")
    parser.add_argument("--from", dest="first", type=int, default=0, help="first deck")
    chosen = parser.parse_args()
    program = str(Path(chosen.program).resolve())
    runner = Runner(program, chosen.ranks)
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    os.environ.pop("TMPDIR", None)
    sections = read_reference(program)
    print(f"random decks of seed {chosen.seed}", flush=True)
    counts, failed, n = {}, 0, 0
    indices = [chosen.only] if chosen.only is not None else range(chosen.first, chosen.first + chosen.decks)
    for index in indices:
        if cpu() > chosen.seconds and chosen.only is None:
            break
        n += 1
        place = Path(tempfile.mkdtemp(prefix=f"random_{chosen.seed}_{index}_", dir=chosen.keep))
        kind, code, fault = one(chosen.seed, index, sections, runner, place)
        outcome = (kind.split(" on ")[0], CODES.get(code) or TOO_LONG.get(code) or f"code {code}")
        counts[outcome] = counts.get(outcome, 0) + 1
        if fault:
            failed += 1
            print(f"deck {index} ({kind}): {fault}\n  kept in {place}; again by: {sys.argv[0]} {chosen.program} --seed {chosen.seed} "
                  f"--only {index}" + (f" --ranks {chosen.ranks}" if chosen.ranks else ""), flush=True)
        elif chosen.only is None:
            shutil.rmtree(place)
        else:
            print(f"{kind}: {CODES.get(code, code)}; {place}")
    for (kind, outcome), count in sorted(counts.items()):
        print(f"  {count:6d} {kind}: {outcome}")
    cut = sum(count for (_, outcome), count in counts.items() if outcome == "cut short")
    if cut > 1 + MOST_CUT * n:
        failed += 1
        print(f"{cut} of {n} runs did not end within {CPU_LIMIT} CPU seconds")
    right = sum(count for (kind, _), count in counts.items() if kind == "right")
    ran = counts.get(("right", "ran"), 0) + counts.get(("right", "not converged"), 0)
    if right >= 20 and ran < right / 4:
        failed += 1
        print(f"of {right} right decks {ran} ran: the generator no longer knows what the program takes")
    print(f"{n - min(n, failed)} passed, {failed} failed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
