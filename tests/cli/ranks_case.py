"""Decks and runs that the tests on several ranks share."""

import csv
import json
import os
import re
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

COMMON = """[time]
step = 1e-3
steps = 60
[solver]
tolerance = 1e-6
[[material]]
name = "sand"
density = 2600.0
[[law]]
friction = 0.3
"""
FLOOR = """[[wall]]
name = "floor"
from = [-0.1, -0.01]
to = [0.7, -0.01]
thickness = 0.02
"""
SIDES = """[[wall]]
name = "left"
from = [-0.01, -0.1]
to = [-0.01, 1.0]
thickness = 0.02
[[wall]]
name = "right"
from = [0.61, -0.1]
to = [0.61, 1.0]
thickness = 0.02
"""
LID = """[[wall]]
name = "lid"
from = [0.0, 0.52]
to = [0.6, 0.52]
thickness = 0.02
pressure = 1e4
direction = [0, -1]
between = ["left", "right"]
"""
BOX = "[[container]]\nsize = [0.3, 0.3, 0.5]\n"
CLUSTERS = "".join(f"""[[body]]
position = [{0.06 + 0.09 * i:g}, {0.03 + 0.05 * j:g}]
[[body.shape]]
kind = "disk"
radius = 0.02
centre = [-0.015, 0.0]
[[body.shape]]
kind = "disk"
radius = 0.02
centre = [0.015, 0.0]
""" for i in range(6) for j in range(2))  # fmt: skip
CLUMPS = """[[clump]]
name = "pair"
[[clump.shape]]
kind = "disk"
radius = 2.0
[[clump.shape]]
kind = "disk"
radius = 1.0
centre = [2.0, 0.0]
[[clump]]
name = "half"
[[clump.shape]]
kind = "polygon"
vertices = [[0, 0], [2, 0], [0, 1]]
"""
DRIVES = """[[drive]]
body = "left"
component = "x"
amplitude = 0.05
frequency = 10.0
[[drive]]
body = 10
component = "rotation"
value = 3.0
"""
BIG_GRAIN = '[[body]]\nshape = "disk"\nradius = 0.12\nposition = [0.3, 0.65]\n'


def grains(count, more=""):
    return f'[[sample]]\nbox = [0.0, 0.0, 0.6, 0.5]\nkind = "lattice"\ncount = {count}\nradius = [0.018, 0.022]\n{more}'


def grains_in_space(count, more=""):
    return ('[[sample]]\nbox = [0.0, 0.0, 0.0, 0.3, 0.3, 0.4]\nkind = "lattice"\n'
            f'count = {count}\nradius = [0.018, 0.022]\n{more}')  # fmt: skip


FALL = COMMON + FLOOR + grains(40)
PRESSED = COMMON + FLOOR + SIDES + grains(60) + LID
GRAPH = ["--set", 'partition.split="graph"']
# One body spins up beyond all numbers in the first step, by the largest torque, step and lightness that a deck may ask for.
BEYOND = """[scene]
gravity = [0.0, 0.0]
[time]
step = 1e49
steps = 5
[[material]]
density = 1e-50
name = "dust"
[[law]]
friction = 0.3
[[sample]]
box = [0.0, 0.0, 4e-40, 3e-40]
kind = "lattice"
count = 12
radius = [3e-41, 4e-41]
[[drive]]
body = 9
component = "rotation"
kind = "force"
value = 1e50
"""


class Ranks(ProgramCase):
    @classmethod
    def setUpClass(cls):
        # Open MPI puts sockets into TMPDIR, and their paths must be short.
        cls.environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                               OMPI_MCA_odls_base_sigkill_timeout="0")  # fmt: skip
        # The last one: once a rank has ended with an exit code above 0, Open MPI waits a second between SIGTERM and SIGKILL for
        # others, which have nothing left to do, as ranks end together.
        cls.environment.pop("TMPDIR", None)

    def deck(self, text, name="deck.toml"):
        (self.place / name).write_text(text)
        return name

    def launch(self, *parts, code=0, environment=None, starter=()):
        """Run `(ranks, words...)` side by side as one parallel run, whose exit code must be this one; one that hangs fails.

        The words of `starter` start the program of the first part."""
        words = [self.launcher, "--oversubscribe"]
        for ranks, *part in parts:
            words += [] if words[-1] == "--oversubscribe" else [":"]
            words += ["-n", str(ranks), *starter, self.program, *map(str, part)]
            starter = ()
        done = subprocess.run(words, cwd=self.place, env=dict(self.environment, **(environment or {})), capture_output=True,
                              text=True, timeout=self.timeout)  # fmt: skip
        self.assertEqual(done.returncode, code, f"{words}\n{done.stdout}\n{done.stderr}")
        return done

    def run_ranks(self, ranks, deck, *words, code=0, output="out"):
        """Run a deck quietly: a run without errors prints nothing. One rank has no launcher, with the same results (`Alone`)."""
        words = ["run", deck, "--quiet", "--force", "--output", output, *words]
        done = self.run_program(*words, code=code) if ranks == 1 else self.launch((ranks, *words), code=code)
        if code == 0:
            self.assertEqual(done.stdout, "")
            self.assertEqual([line for line in done.stderr.splitlines() if "warning" not in line], [])
        return done

    def refused(self, ranks, deck, said, *words, code=2):
        """A run that cannot be says why, once, and nothing else."""
        done = self.run_ranks(ranks, deck, *words, code=code)
        self.assertEqual(len(re.findall(said, done.stderr)), 1, done.stderr)
        self.assertEqual(done.stderr.count("error:"), 1, done.stderr)
        self.assertEqual(done.stdout, "")
        return done

    def run_json(self, folder="out"):
        return json.loads((self.place / folder / "run.json").read_text())

    def rows(self, folder="out"):
        with open(self.place / folder / "record.csv", newline="") as file:
            return list(csv.DictReader(file))

    def compare(self, first, second, tolerance, names):
        """Values of two runs must agree, relative to the larger or, where both are next to nothing, to the scale given."""
        for name, scale in names.items():
            one, other = first[name], second[name]
            self.assertLessEqual(abs(one - other), tolerance * max(abs(one), abs(other), scale), f"{name}: {one} and {other}")

    def state(self, deck, folder):
        """Positions and velocities of bodies, and contacts by pair with their normal impulses, of the last checkpoint."""
        target = self.place / f"state of {folder}"
        self.run_program("convert", deck, target.name, "--restart", folder)
        def value(word):
            return float(word.replace("D", "e"))

        number = r"([-+ ]?\d\.\d+D[-+]\d+)"
        named = rf"(coo\d|[XV]\(\d\)) *={number}"
        places, moves = (re.findall(named, (target / file).read_text()) for file in ("BODIES.DAT", "DOF.INI"))
        values = iter([value(word) for _, word in places])
        # Where each body is, in the plane x, y and the angle, and how fast it moves: six numbers per body.
        bodies = [value(word) + (next(values) if name.startswith("X") else 0.0) for name, word in moves]
        contacts = {}
        for block in (target / "Vloc_Rloc.INI").read_text().split("$icdan")[1:]:
            pair = tuple(map(int, re.findall(r"RBDY\d +(\d+)", block)))
            contacts.setdefault(pair, []).append(value(re.search(rf"rln/H{number}", block)[1]))
        return bodies, {pair: sorted(forces) for pair, forces in contacts.items()}


def take_launcher():
    """Take the program and, where there is one and the program has MPI, its launcher from the command line."""
    take_program()
    printed = subprocess.run([ProgramCase.program, "--version"], capture_output=True, text=True, timeout=60).stdout
    if re.search(r"^MPI +off", printed, re.M):
        ProgramCase.launcher = None
