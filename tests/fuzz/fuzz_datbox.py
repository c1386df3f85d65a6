#!/usr/bin/env python3
"""DATBOX folders at random: right ones, the same in another dialect, and spoilt ones.

A right folder must be read. Its twin in another dialect has everything that LMGC90's readers pass over (stray lines, comments,
letters before keywords, labels, letters of exponents, blank zeros, earlier blocks that later ones replace, blocks that nothing
ends) and must give the same scene and the same steps, digit by digit. A spoilt one must be read or refused with a sentence.
"""

import math
import random
import re
import sys

from fuzz_decks import compare
from fuzz_harness import Outcome, fuzz, judge, run, worst

STRAY = ["########", " ! a remark", " #####", "1! File", "  text between blocks", " $behav", "$what", " title   1.0  2.0"]
COMMENTS = ["! remark", "#", "", "   ", "!$bdyty", "# RBDY2      1"]
DECK = """[scene]
dimension = {dimension}
datbox = "{folder}"
[time]
step = 1e-3
steps = 3
[solver]
maximum_sweeps = 200
[output]
record_every = 1
"""


def number(value):
    """A number in fourteen columns."""
    mantissa, exponent = f"{value: .7e}".split("e")
    return f"{mantissa}D{int(exponent):+03d}"


def row(head, values, labels="coo1= coo2= coo3="):
    """A line of up to three numbers behind their labels in the usual columns."""
    words = [f"{label:5}{number(value)}" for label, value in zip(labels.split(), values)]
    return f"{head:29}" + "  ".join(words)


class Folder:
    """The files of a folder as lists of lines. A line that begins with `@` may have stray lines before it; the mark is no part of it."""

    def __init__(self, rng, dimension):
        self.rng, self.dimension, self.n, self.files = rng, dimension, 0, {}
        self.shapes = set()
        self.body = f"RBDY{dimension}"
        self.node = "NO3xx" if dimension == 2 else "NO6xx"
        self.files["BODIES.DAT"] = self.bodies()
        self.files["BULK_BEHAV.DAT"] = self.bulk()
        self.files["TACT_BEHAV.DAT"] = self.tact()
        self.files["DRV_DOF.DAT"] = self.drives()
        self.files["DOF.INI"] = self.state()
        self.files["Vloc_Rloc.INI"] = ["@$steps        0              time= 0.0000000D+00"]
        self.files["push.dat"] = ["0.0 0.0", f"1.0 {rng.uniform(-5, 5)!r}", f"  2.0   {rng.uniform(-5, 5)!r}"]

    def bulk(self):
        """Gravity, a rigid law and a coupled one."""
        gravity = [self.rng.choice([0.0, 1.0]), -9.81, 0.0]
        return ["@$gravy", "                   " + "  ".join(f"grv{i + 1}={number(gravity[i])}" for i in range(3)),
                "@$behav  lawty", f" PLEXx  RIGID                           Umas={number(2000.0)}",
                "@$behav  lawty", f" TDURx  ELECTRO_RIGID                   Umas={number(3000.0)}",
                "                                        Ecnd= 0.1000000D+03"]

    def tact(self):
        """Laws of one to three lines, and a see table for each pair of shapes that LMGC90 detects."""
        laws = [["@$behav  lawty", f" law00  IQS_CLB                         fric={number(0.3)}"],
                ["@$behav  lawty", f" law01  RST_CLB                         rstn={number(0.5)}  rstt={number(0.0)}",
                 f"                                        fric={number(0.2)}"],
                ["@$behav  lawty", f" law02  IQS_WET_DS_CLB                  cohn={number(1.0)}  coht={number(0.0)}",
                 f"                                        Wthk={number(1e-3)}",
                 f"                                        dyfr={number(0.2)}  stfr={number(0.3)}"]]
        lines = [line for law in laws for line in law]
        pairs = (["DISKx DISKx", "DISKx JONCx", "DISKx xKSID", "DISKx POLYG", "POLYG POLYG", "POLYG JONCx"] if self.dimension == 2
                 else ["SPHER SPHER", "SPHER PLANx", "SPHER CYLND", "SPHER POLYR", "CYLND CYLND", "CYLND PLANx", "POLYR POLYR",
                       "POLYR PLANx"])
        for pair in pairs:
            first, second = pair.split()
            if {first, second} <= self.shapes:
                lines += ["@$seety", " cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert",
                          f" {self.body}  {first}  BLEUx  law0{self.rng.randrange(3)}  {self.body}  {second}  BLEUx      "
                          f"{number(0.05)}"]
                if self.rng.random() < 0.2:
                    lines.append(f"+{number(0.1):>68}")
        return lines

    def bodies(self):
        """Bodies of all shapes on a lattice, and a floor."""
        lines = []
        for i in range(self.rng.randint(2, 7)):
            place = [0.41 * (i % 3), 0.41 * (i // 3), 0.0][:self.dimension]
            if self.dimension == 3:
                place = [place[0], 0.0, place[1]]
            lines += self.one_body(place, self.shape_2d if self.dimension == 2 else self.shape_3d)
        floor = self.floor_2d if self.dimension == 2 else self.floor_3d
        return lines + self.one_body([0.3, -0.3] if self.dimension == 2 else [0.3, 0.0, -0.3], floor)

    def one_body(self, place, shape):
        """A body's block."""
        self.n += 1
        shapes, is_global = shape(place)
        node = [0.0] * self.dimension if is_global else place
        bulk = self.rng.choice(["PLEXx", "TDURx"])
        lines = ["@$bdyty", f" {self.body}{self.n:7d}", "@$blmty",
                 f" PLAIN      1  behav  {bulk}  avrd={number(0.0)}  gyrd={number(0.0)}"]
        if self.dimension == 3 and self.rng.random() < 0.5:
            lines.append(row("", [0.0] * 3, "I1  = I2  = I3  ="))
        lines += ["$nodty", row(f" {self.node}      1", (node + [0.0])[:3])]
        if self.dimension == 3:
            lines.append(row("", [0.0] * 3, "coo4= coo5= coo6="))
        return lines + ["$tacty", *shapes, "$$$$$$"]

    def head(self, kind, index=1):
        """The head of a contactor's line; a see table names shifted disks and spheres like others."""
        self.shapes.add({"DISKb": "DISKx", "SPHEb": "SPHER"}.get(kind, kind))
        return f" {kind}  {index:5d}  color  BLEUx"

    def shape_2d(self, place):
        """A disk, a cluster, or a polygon, about its centroid or in global coordinates."""
        kind = self.rng.randrange(3)
        if kind == 0:
            return [row(self.head("DISKx"), [0.2], "byrd=")], False
        if kind == 1:
            return [row(self.head("DISKb"), [0.1], "byrd="), row("", [0.1, 0.0]),
                    row(self.head("DISKb", 2), [0.1], "byrd="), row("", [-0.1, 0.0])], False
        is_global = self.rng.random() < 0.5 and any(place)
        n = self.rng.randint(3, 6)
        corners = [(0.2 * math.cos(2 * math.pi * k / n), 0.2 * math.sin(2 * math.pi * k / n)) for k in range(n)]
        offset = place if is_global else [0.0, 0.0]
        return [f"{self.head('POLYG')}  nb_vertex={n:7d}    byrd={number(0.0)}",
                *(row("", [x + offset[0], y + offset[1]]) for x, y in corners)], is_global

    def floor_2d(self, _):
        """A segment, or a drum without mass."""
        if self.rng.random() < 0.7:
            return [row(self.head("JONCx"), [1.0, 0.1], " ax1=  ax2=")], False
        return [row(self.head("xKSID"), [3.0], "byrd=")], False

    def shape_3d(self, _):
        """A sphere, a cluster, a cylinder or a brick."""
        kind = self.rng.randrange(4)
        if kind == 0:
            return [row(self.head("SPHER"), [0.2], "byrd=")], False
        if kind == 1:
            return [row(self.head("SPHEb"), [0.1], "byrd="), row("", [0.1, 0.0, 0.0]),
                    row(self.head("SPHEb", 2), [0.1], "byrd="), row("", [-0.1, 0.0, 0.0])], False
        if kind == 2:
            return [row(self.head("CYLND"), [0.1, 0.1], "High= byrd=")], False
        corners = [[sx * 0.2, sy * 0.2, sz * 0.2] for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
        faces = [(1, 3, 2), (2, 3, 4), (5, 6, 7), (6, 8, 7), (1, 2, 5), (2, 6, 5), (3, 7, 4), (4, 7, 8), (1, 5, 3), (3, 5, 7),
                 (2, 4, 6), (4, 8, 6)]
        triangles = [f"{'':29}" + "         ".join(f"ver{k + 1}={v:7d}" for k, v in enumerate(face)) for face in faces]
        return [f"{self.head('POLYR')}  nb_vertex={8:7d}    nb_faces={12:7d}", *(row("", c) for c in corners), *triangles], False

    def floor_3d(self, _):
        """A plane, with or without a frame of its own."""
        lines = [row(self.head("PLANx"), [1.0, 1.0, 0.1], "axe1= axe2= axe3=")]
        if self.rng.random() < 0.5:
            lines += [f"{'':29}localframe", row("", [0.0, 1.0, 0.0], "alp1= alp2= alp3="),
                      row("", [-1.0, 0.0, 0.0], "bet1= bet2= bet3="), row("", [0.0, 0.0, 1.0], "gam1= gam2= gam3="),
                      row("", [0.0, 0.0, 0.0])]
        return lines, False

    def block(self, body, first, last):
        """A body's block of drives that holds it, and moves one component."""
        lines = ["@$bdyty", f" {self.body}{body:7d}", "@$nodty", f" {self.node}      1", "@$dofty  numbr"]
        moved = self.rng.randint(first, last)
        for component in range(first, last + 1):
            value = [self.rng.uniform(-0.1, 0.1) if component == moved else 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]
            lines.append(f" vlocy  {component:5d} " + " ".join(number(v) for v in value))
        return [*lines, "$$$$$$"]

    def drives(self):
        """The floor is held in all components; perhaps a body is pushed by a table."""
        lines = self.block(self.n, 1, 3 if self.dimension == 2 else 6)
        if self.rng.random() < 0.5:
            lines += ["@$bdyty", f" {self.body}{1:7d}", "@$nodty", f" {self.node}      1", "@$dofty",
                      " force      1 evolution push.dat", "$$$$$$"]
        return lines

    def state(self):
        """Displacements and velocities of some bodies."""
        lines = ["@$steps        0              time= 0.0000000D+00"]
        for body in range(1, self.n):
            if self.rng.random() < 0.6:
                lines += ["@$bdyty", f" {self.body}{body:7d}", "@$nodty", *self.body_state(), "$$$$$$"]
        return lines

    def body_state(self):
        """Lines of one body's state."""
        moved = [self.rng.uniform(-0.02, 0.02) for _ in range(6)]
        if self.dimension == 2:
            return [row(f" {self.node}      1", moved[:3], "X(1)= X(2)= X(3)="), row("", moved[3:], "V(1)= V(2)= V(3)=")]
        return [row(f" {self.node}      1", moved[:3], "X(1)= X(2)= X(3)="), row("", [0.0] * 3, "X(4)= X(5)= X(6)="),
                row("", moved[3:], "V(1)= V(2)= V(3)="), row("", [0.0] * 3, "V(4)= V(5)= V(6)="),
                row("", [1.0, 0.0, 0.0], "a(1)= a(2)= a(3)="), row("", [0.0, 1.0, 0.0], "b(1)= b(2)= b(3)="),
                row("", [0.0, 0.0, 1.0], "g(1)= g(2)= g(3)=")]


def plain(files):
    """The files as they are."""
    return {name: "\n".join(line.removeprefix("@") for line in lines).encode() + b"\n" for name, lines in files.items()}


def in_dialect(rng, folder):
    """The same folder in another dialect."""
    files = dict(folder.files)
    if rng.random() < 0.5:
        # An earlier block of the floor, which the last one replaces.
        twin = Folder(random.Random(rng.random()), folder.dimension)
        files["DRV_DOF.DAT"] = twin.block(folder.n, 1, 3) + files["DRV_DOF.DAT"]
    share, written = rng.uniform(0, 0.4), {}
    for name, lines in files.items():
        if name == "push.dat":
            written[name] = ("\n".join("   " + line.replace(" ", "   ") for line in lines) + "\n").encode()
            continue
        open_lines = without_ends(rng, name, lines, share)
        is_open = open_lines[-1] != lines[-1]
        lines = [line for old in open_lines for line in spelt(rng, name, old, share)]
        if rng.random() < share and not is_open:
            lines += [rng.choice(STRAY)]
        end = rng.choice(["\n", "\n", "\r\n"])
        written[name] = (end.join(lines) + end).encode()
    return written


def without_ends(rng, name, lines, share):
    """The lines of a file without some of those that end a body's block: the next body or the end of the file does that as well;
    in BODIES.DAT the end of the file alone."""
    lines = list(lines)
    for i in reversed([i for i, line in enumerate(lines) if line == "$$$$$$"]):
        is_last = i == len(lines) - 1
        if rng.random() < share and (is_last or name != "BODIES.DAT"):
            del lines[i]
            if not is_last:
                # A stray line would now stand within the block before.
                lines[i] = lines[i].removeprefix("@")
    return lines


def spelt(rng, name, line, share):
    """A line, perhaps with others before it, that means the same."""
    added = [rng.choice(COMMENTS) for _ in range(rng.randint(1, 2))] if rng.random() < share else []
    if line.startswith("@"):
        line = line[1:]
        # A stray line before a section of a body begins would stand within the section before it.
        if rng.random() < share and not (name == "BODIES.DAT" and line[1:6] == "nodty"):
            added.append(rng.choice(STRAY))
    if line[1:6] in ("bdyty", "blmty", "nodty", "tacty", "dofty", "behav", "seety", "gravy", "$$$$$") and rng.random() < share:
        return [*added, rng.choice(["x", " ", "$", "."]) + line[1:6] + rng.choice(["", "  text", "  1.0"])]
    if rng.random() < share and "evolution" not in line:
        line = re.sub(r"(?<=\d)D(?=[+-]\d)", rng.choice("dEe"), line)
    if rng.random() < share and line[29:30] in "cgkXVIab" and not line.startswith("$"):
        # Labels: all but the one letter or word by which LMGC90 distinguishes lines.
        line = re.sub(r"(coo|avrd|gyrd|byrd|nb_)(?=\S*=)", lambda found: "x" * len(found[0]), line) if line[29:30] == "c" else line
    if rng.random() < share:
        line = re.sub(r" 0\.0000000[DdEe]\+00(?=\s*$)", "", line)
    if rng.random() < share and not line.startswith("$") and "evolution" not in line:
        line = line + " " * rng.randint(1, 9)
    return [*added, line]


def spoil(rng, files):
    """Some bytes or lines of some files changed."""
    spoilt = dict(files)
    for _ in range(rng.randint(1, 3)):
        name = rng.choice(sorted(spoilt))
        lines = spoilt[name].split(b"\n")
        at, way = rng.randrange(len(lines)), rng.randrange(7)
        if way == 0:
            del lines[at]
        elif way == 1:
            lines.insert(at, rng.choice(lines))
        elif way == 2:
            lines = lines[:at]
        elif way == 3 and lines[at]:
            letter = rng.randrange(len(lines[at]))
            lines[at] = lines[at][:letter] + bytes([rng.randrange(256)]) + lines[at][letter + 1:]
        elif way == 4:
            lines[at] = re.sub(rb"[ -]\d\.\d{7}D[+-]\d\d", rng.choice([b" 0.1000000-308", b" 1.0000000D+59", b"-1.0000000D+00",
                                                                      b" 0.0000000D+00", b"           NaN"]), lines[at], count=1)
        elif way == 5:
            lines[at] = re.sub(rb" \d ", rng.choice([b" 0 ", b" 9 ", b"99999999 ", b" -1 "]), lines[at], count=1)
        else:
            lines[at] = lines[at][rng.randint(0, 30):]
        spoilt[name] = b"\n".join(lines)
    return spoilt


def write(place, name, dimension, files):
    """A folder and a deck that runs it."""
    (place / name).mkdir()
    for file, content in files.items():
        (place / name / file).write_bytes(content)
    (place / f"{name}.toml").write_text(DECK.format(dimension=dimension, folder=name))
    return f"{name}.toml"


def try_case(rng, program, place, _):
    """A right folder with its twin in another dialect, or a spoilt one."""
    folder = Folder(rng, rng.choice([2, 3]))
    files = plain(folder.files)
    if rng.random() < 0.5:
        deck = write(place, "spoilt", folder.dimension, spoil(rng, files))
        return judge(run(program, ["run", deck, "--output", "results", "--quiet"], place), place)
    outcomes = []
    for name, content in (("first", files), ("second", in_dialect(rng, folder))):
        deck = write(place, name, folder.dimension, content)
        outcomes.append(judge(run(program, ["run", deck, "--output", f"{name}_results", "--quiet"], place), place, f"{name}_results"))
        outcomes.append(judge(run(program, ["convert", deck, f"{name}_written"], place)))
        if outcomes[-2].word == "refused":
            return Outcome("wrong", f"the {name} of two right folders is refused")
    outcome = worst(outcomes)
    if outcome.word not in ("clean", "refused"):
        return outcome
    different = compare(place / "first_results", place / "second_results") or compare_written(place)
    return Outcome("wrong", different) if different else Outcome("clean")


def compare_written(place):
    """The first file in which the scenes of the twins differ, both written by `convert`."""
    for file in sorted((place / "first_written").glob("*")):
        other = place / "second_written" / file.name
        if not other.exists() or file.read_bytes() != other.read_bytes():
            return f"{file.name} of the scene differs in another dialect"
    return ""


if __name__ == "__main__":
    sys.exit(fuzz("datbox", __doc__, try_case))
