#!/usr/bin/env python3
"""Test runs on several ranks from outside: what goes wrong ends soon, is said once, and leaves a checkpoint that serves.

usage: test_ranks.py PROGRAM MPIEXEC [unittest options]
"""

import csv
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
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
    launcher = None

    @classmethod
    def setUpClass(cls):
        # Open MPI puts sockets into TMPDIR, and their paths must be short.
        cls.environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        cls.environment.pop("TMPDIR", None)

    def deck(self, text, name="deck.toml"):
        (self.place / name).write_text(text)
        return name

    def launch(self, *parts, code=0, environment=None):
        """Run `(ranks, words...)` side by side as one parallel run, whose exit code must be this one; one that hangs fails."""
        words = [self.launcher, "--oversubscribe"]
        for ranks, *part in parts:
            words += [] if words[-1] == "--oversubscribe" else [":"]
            words += ["-n", str(ranks), self.program, *map(str, part)]
        done = subprocess.run(words, cwd=self.place, env=dict(self.environment, **(environment or {})), capture_output=True,
                              text=True, timeout=self.timeout)  # fmt: skip
        self.assertEqual(done.returncode, code, f"{words}\n{done.stdout}\n{done.stderr}")
        return done

    def run_ranks(self, ranks, deck, *words, code=0, output="out"):
        """Run a deck quietly: a run that goes well says nothing at all."""
        done = self.launch((ranks, "run", deck, "--quiet", "--output", output, *words), code=code)
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
        # Where each body is, in the plane x, y and the angle, and how fast it moves: six numbers a body.
        bodies = [value(word) + (next(values) if name.startswith("X") else 0.0) for name, word in moves]
        contacts = {}
        for block in (target / "Vloc_Rloc.INI").read_text().split("$icdan")[1:]:
            pair = tuple(map(int, re.findall(r"RBDY\d +(\d+)", block)))
            contacts.setdefault(pair, []).append(value(re.search(rf"rln/H{number}", block)[1]))
        return bodies, {pair: sorted(forces) for pair, forces in contacts.items()}


class Alone(Ranks):
    def test_one_rank_is_the_run_without_launcher(self):
        deck = self.deck(PRESSED)
        words = ["run", deck, "--quiet"] + (["--set", "restart.every=60"] if self.has_hdf5() else [])
        begin = int(time.time()) - 1
        self.run_program(*words, "--output", "serial")
        self.launch((1, *words, "--output", "alone"))
        times = re.compile("seconds|^cpu_|^wall_")
        for row, same in zip(self.rows("serial"), self.rows("alone"), strict=True):
            self.assertEqual(*({k: v for k, v in values.items() if not times.search(k)} for values in (row, same)))
        tags = [(self.place / folder / "numbers.tag").read_text().splitlines() for folder in ("serial", "alone")]
        for line, same in zip(*tags, strict=True):
            if not re.search("second|_cpu|_wall|memory", line):
                self.assertEqual(line, same)
        if self.has_hdf5():
            files = [(self.place / folder / "restart_a.h5").read_bytes() for folder in ("serial", "alone")]
            self.assertEqual(len(files[0]), len(files[1]))

            def is_stamp(i):
                # HDF5 keeps with each dataset when it was made, in whole seconds.
                made = [[int.from_bytes(file[k : k + 4], "little") for file in files] for k in range(i - 3, i + 1)]
                return any(begin <= min(times) and max(times) <= time.time() for times in made)

            # Of the datasets one may differ: among other sums of the run it holds times, some fifty numbers in one place.
            where = [i for i, (a, b) in enumerate(zip(*files)) if a != b and not is_stamp(i)]
            self.assertLess(where[-1] - where[0] if where else 0, 8 * 60)

    def test_one_rank_never_starts_mpi(self):
        # Open MPI lists its parameters when it starts, and no call but that may come before it starts.
        deck = self.deck(FALL)
        told = {"OMPI_MCA_mpi_show_mca_params": "all"}
        words = ["run", deck, "--quiet", "--set", "time.steps=3"]
        if "mpi_show_mca_params" not in "".join(self.launch((2, *words), environment=told).stderr):
            self.skipTest("this MPI does not tell that it starts")
        self.assertEqual(self.launch((1, *words), environment=told).stderr, "")
        done = subprocess.run([self.program, *words], cwd=self.place, env=dict(self.environment, **told), capture_output=True,
                              text=True, timeout=self.timeout)  # fmt: skip
        self.assertEqual((done.returncode, done.stderr), (0, ""))


class Refusals(Ranks):
    def test_bad_decks_and_wishes(self):
        self.deck(FALL.replace("friction =", "frction ="), "bad.toml")
        good = self.deck(FALL)
        for ranks, deck, said, words in (
            (3, "bad.toml", 'bad.toml:10:1: error: unknown key "frction".*; did you mean "friction"', []),
            (2, "nowhere.toml", "nowhere.toml: error: cannot read the file", []),
            (2, good, "partition.sweeps has 3 numbers; .* for each of the 2 ranks", ["--set", "partition.sweeps=[1, 2, 3]"]),
            (4, good, r"boxes 3 x 2 .* cannot make 4 parts", ["--set", "partition.boxes=[3, 2]"]),
            (2, good, '"interior" works on one rank', ["--set", 'solver.method="interior"']),
            (2, good, "unknown option --outptu", ["--outptu=x"]),
            (2, good, "--walltime needs a value", ["--walltime"]),
        ):  # fmt: skip
            with self.subTest(said=said):
                self.refused(ranks, deck, said, *words)
        self.assertEqual(self.launch((2, "rnu"), code=2).stderr.count('did you mean "run"'), 1)

    def test_ranks_that_do_not_share_one_run(self):
        good = self.deck(FALL)
        bad = self.deck(FALL.replace("friction =", "frction ="), "bad.toml")
        other = self.deck(FALL.replace("friction = 0.3", "friction = 0.4"), "other.toml")
        for words, said in (
            ([bad], "1 of 2 ranks find this, the first is rank 1"),
            (["nowhere.toml"], "1 of 2 ranks find this, the first is rank 1"),
            ([other], "the ranks do not share one run"),
            ([good, "--output", "elsewhere"], "the ranks do not share one run"),
            ([good, "--outptu", "x"], "unknown option --outptu"),
            ([good, "--walltime"], "--walltime needs a value"),
        ):
            with self.subTest(words=words):
                done = self.launch((1, "run", good, "--quiet"), (1, "run", *words), code=2)
                self.assertEqual((done.stderr.count(said), done.stderr.count("error:")), (1, 1), done.stderr)
        for folder in ("here", "there"):
            (self.place / folder).mkdir()
            self.deck(FALL, f"{folder}/deck.toml")
        done = subprocess.run(
            [self.launcher, "--oversubscribe", "-n", "1", "-wdir", self.place / "here", self.program, "run", good, ":",
             "-n", "1", "-wdir", self.place / "there", self.program, "run", good],
            env=self.environment, capture_output=True, text=True, timeout=self.timeout)  # fmt: skip
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertEqual(done.stderr.count("rank 1 does not find the folder of the results"), 1, done.stderr)

    def test_bodies_beyond_all_numbers_are_named(self):
        if "ffpe-trap" in self.run_program("--version").stdout:
            self.skipTest("this build stops where numbers overflow")
        deck = self.deck(BEYOND)
        said = "step 1: velocities without contacts, from forces and drives, are not finite of bodies 9;"
        for ranks in (1, 4):
            self.refused(ranks, deck, said, code=4)
            self.assertEqual(self.run_json()["status"], "failed")
            self.assertRegex(self.run_json()["reason"], said)
        if self.has_hdf5():
            # The checkpoint is of the state before.
            self.refused(2, deck, said, "--restart", "out", code=4)

    def test_a_step_that_does_not_converge(self):
        deck = self.deck(FALL)
        hard = ["--set", "solver.maximum_sweeps=1", "--set", "solver.tolerance=1e-14", "--set", "solver.check_every=1"]
        self.run_ranks(3, deck, *hard, "--set", "solver.stop_unconverged=true", code=3)
        self.assertEqual(self.run_json()["status"], "not converged")
        if self.has_hdf5():
            # All ranks together leave the problem of the step.
            step = self.run_json()["steps"]
            self.assertEqual(self.run_json()[f"file_dump_{step}"], f"dump-{step}-local.hdf5")
            self.solve_all(["out"], [f"dump-{step}"])


    def solve_all(self, folders, names):
        """Solve both forms of dumps; number of contacts by file."""
        files = [f"{folder}/{name}-{form}.hdf5" for folder in folders for name in names for form in ("local", "global")]
        lines = [json.loads(line) for line in self.run_program("solve", *files, "--json").stdout.splitlines()]
        self.assertEqual([line["file"] for line in lines], files)
        self.assertLess(max(line["e1"] for line in lines), 1e-8)
        return [line["contacts"] for line in lines]

    def test_dumps_hold_the_whole_problem(self):
        if not self.has_hdf5():
            self.skipTest("built without HDF5")
        deck = self.deck(PRESSED)
        for ranks in (1, 3):
            self.run_ranks(ranks, deck, "--dump", "1,50-51", output=f"on {ranks}")
        names = ["dump-1", "dump-50", "dump-51"]
        one, many = (self.solve_all([f"on {ranks}"], names) for ranks in (1, 3))
        self.assertGreater(min(one), 0)
        self.assertEqual(one, many)


class Shares(Ranks):
    def test_more_ranks_than_grains(self):
        kept = {"kinetic_energy": 1e-9, "potential_energy": 1.0, "contacts": 1.0, "compactness": 1.0}
        for name, ranks, text in (
            ("two grains", 4, COMMON + FLOOR + grains(2)),
            ("one grain", 3, COMMON + FLOOR + grains(1)),
            ("walls alone", 3, COMMON + FLOOR + SIDES),
        ):
            for words in ([], GRAPH) if self.has_library("METIS") else ([],):
                with self.subTest(name, words=words):
                    deck = self.deck(text)
                    self.run_ranks(1, deck, output="one")
                    self.run_ranks(ranks, deck, *words, output="many")
                    self.compare(self.run_json("one"), self.run_json("many"), 1e-9, kept)

    def test_every_kind_of_scene_is_the_same_on_several_ranks(self):
        # A residual of 1e-6 leaves this much freedom to positions and velocities; that of a fall is none.
        kept = {"kinetic_energy": 1e-6, "potential_energy": 1.0, "compactness": 1.0, "contacts": 1.0}
        split = GRAPH if self.has_library("METIS") else []
        for name, text in (
            ("drives", COMMON + FLOOR + SIDES + grains(60) + DRIVES),
            ("periodic", "[scene]\nperiod_x = 0.6\n" + COMMON + FLOOR + grains(60)),
            ("clusters", COMMON + FLOOR + SIDES + CLUSTERS),
            ("polygons", COMMON + FLOOR + SIDES + grains(40, 'shape = "polygon"\n')),
            ("a big grain among small ones", COMMON + FLOOR + SIDES + BIG_GRAIN + grains(60)),
            ("spheres", "[scene]\ndimension = 3\n" + COMMON + BOX + grains_in_space(60)),
            ("polyhedra", "[scene]\ndimension = 3\n" + COMMON + BOX + grains_in_space(40, 'shape = "polyhedron"\n')),
        ):
            if name == "polyhedra" and not self.has_library("Qhull"):
                continue
            with self.subTest(name):
                deck = self.deck(text)
                self.run_program("run", deck, "--quiet", "--output", "one")
                self.run_ranks(3, deck, *split, output="many")
                self.assertGreater(self.run_json("one")["contacts"], 0)
                self.assertLess(self.run_json("many")["worst_e8"], 1e-5)
                self.compare(self.run_json("one"), self.run_json("many"), 1e-4, kept)

    def test_criteria_that_look_at_increments(self):
        deck = self.deck(PRESSED)
        # The pack at rest; they measure increments, and leave errors far larger than their tolerance.
        kept = {"potential_energy": 1.0, "compactness": 1.0, "contacts": 1.0}
        for criterion in ("quad", "maxm", "qm16"):
            words = ["--set", f'solver.criterion="{criterion}"', "--set", "solver.tolerance=1e-8"]
            self.run_ranks(1, deck, *words, output="one")
            for gluing in ("dual", "primal"):
                with self.subTest(criterion, gluing=gluing):
                    self.run_ranks(3, deck, *words, "--set", f'partition.gluing="{gluing}"', output="many")
                    self.assertLess(self.run_json("many")["worst_e8"], 1e-5)
                    self.compare(self.run_json("one"), self.run_json("many"), 1e-5, kept)

    def test_traces_are_of_the_whole_problem_and_change_nothing(self):
        deck = self.deck(PRESSED)
        words = ["--set", "time.steps=40", "--set", "output.record_every=1"]
        for gluing in ("dual", "primal", "contacts"):
            with self.subTest(gluing):
                self.run_ranks(3, deck, *words, "--set", f'partition.gluing="{gluing}"', output="silent")
                self.run_ranks(3, deck, *words, "--set", f'partition.gluing="{gluing}"', "--set", "report.trace=true",
                               "--set", "report.trace_steps=40", output="traced")
                for row, same in zip(self.rows("traced"), self.rows("silent"), strict=True):
                    kept = [name for name in row if "seconds" not in name and not name.startswith(("cpu_", "wall_"))]
                    self.assertEqual([row[name] for name in kept], [same[name] for name in kept])
                self.assertEqual(self.run_json("traced")["bytes_per_gluing"], self.run_json("silent")["bytes_per_gluing"])
                points = list(csv.DictReader((self.place / "traced/trace.csv").read_text().splitlines()))
                last = self.rows("traced")[-1]
                for name in ("contact_updates", "e1", "e2", "e8"):
                    self.assertEqual(points[-1][name], last[name], name)
                self.assertEqual(points[0]["iteration"], "0")
                self.assertLess(float(points[-1]["e1"]), 0.1 * float(points[0]["e1"]))

    def test_a_wall_under_pressure_is_where_one_rank_has_it(self):
        if not self.has_hdf5():
            self.skipTest("built without HDF5")
        deck = self.deck(PRESSED)
        words = ["--set", "time.steps=100", "--set", "restart.every=100", "--set", "output.record_every=0"]
        self.run_ranks(1, deck, *words, output="one")
        one, contacts = self.state(deck, "one")
        for gluing in ("dual", "primal", "contacts"):
            with self.subTest(gluing):
                self.run_ranks(4, deck, *words, "--set", f'partition.gluing="{gluing}"', output="many")
                many, shared = self.state(deck, "many")
                (self.place / "state of many").rename(self.place / f"state of many, {gluing}")
                # The lid is the fourth body, and starts at 0.52 m.
                self.assertLess(one[6 * 3 + 1], 0.51, "the lid does not move")
                self.assertAlmostEqual(many[6 * 3 + 1], one[6 * 3 + 1], delta=1e-6)
                self.assertEqual(shared.keys(), contacts.keys())


class Restarts(Ranks):
    def setUp(self):
        super().setUp()
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")

    def test_numbers_of_ranks_may_change(self):
        deck = self.deck(PRESSED + DRIVES)
        every = ["--set", "restart.every=30"]
        self.run_ranks(1, deck, *every, "--set", "time.steps=120", output="straight")
        split = GRAPH if self.has_library("METIS") else ["--set", "partition.boxes=[3, 1]"]
        for part, (ranks, words) in enumerate(((1, []), (3, split), (2, ["--set", 'partition.gluing="primal"']), (1, []))):
            on = ["--restart", "parts"] if part else []
            self.run_ranks(ranks, deck, *every, *words, *on, "--set", f"time.steps={30 * (part + 1)}", output="parts")
        straight, parts = self.run_json("straight"), self.run_json("parts")
        self.assertEqual((straight["steps"], straight["contacts"]), (parts["steps"], parts["contacts"]))
        # Sums over the whole run, each to the tolerance of the steps.
        self.compare(straight, parts, 1e-5, {"potential_energy": 1.0, "impact_loss": 1.0, "friction_loss": 1.0,
                                             "external_work": 1.0, "drive_work": 1.0})  # fmt: skip
        self.assertEqual([row["step"] for row in self.rows("straight")], [row["step"] for row in self.rows("parts")])
        (bodies, contacts), (others, impulses) = self.state(deck, "straight"), self.state(deck, "parts")
        self.assertEqual(len(bodies), len(others))
        self.assertLess(max(abs(a - b) for a, b in zip(bodies, others)), 1e-5)
        self.assertEqual(contacts.keys(), impulses.keys())
        largest = max(max(forces) for forces in contacts.values())
        for pair, forces in contacts.items():
            for force, other in zip(forces, impulses[pair], strict=True):
                self.assertAlmostEqual(force, other, delta=1e-3 * largest, msg=f"{pair}")

    def test_time_goes_on_with_another_step(self):
        deck = self.deck(PRESSED + DRIVES)
        every = ["--set", "restart.every=30", "--set", "output.record_every=1"]
        for ranks, others in ((1, 3), (3, 1)):
            with self.subTest(ranks=ranks):
                self.run_ranks(ranks, deck, *every, "--set", "time.steps=30", output=f"of {ranks}")
                for total, step, on in ((50, 5e-4, others), (60, 2e-3, ranks)):
                    self.run_ranks(on, deck, *every, "--set", f"time.steps={total}", "--set", f"time.step={step}",
                                   "--set", "restart.every=10", "--restart", f"of {ranks}", output=f"of {ranks}")  # fmt: skip
                times = [float(row["time"]) for row in self.rows(f"of {ranks}")]
                steps = [b - a for a, b in zip(times, times[1:])]
                self.assertEqual(len(times), 60)
                for got, asked in zip(steps, 29 * [1e-3] + 20 * [5e-4] + 10 * [2e-3], strict=True):
                    self.assertAlmostEqual(got, asked, delta=1e-12)

    def test_nothing_left_to_do(self):
        deck = self.deck(FALL)
        self.run_ranks(1, deck, "--set", "restart.every=60")
        self.run_ranks(3, deck, "--restart", "out", "--set", "restart.every=60")
        self.assertEqual((self.run_json()["status"], self.run_json()["steps"]), ("done", 60))

    def fill(self, path):
        """Leave room for a few small texts alone on a disk."""
        with open(path, "wb", buffering=0) as file:
            try:
                while True:
                    file.write(bytes(4096))
            except OSError:
                file.truncate(max(0, file.tell() - 4096))

    def test_full_disk(self):
        small = self.place / "small"
        small.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", small], capture_output=True).returncode:
            self.skipTest("no small disk can be mounted here")
        self.addCleanup(subprocess.run, ["umount", small], capture_output=True)
        deck = self.deck(COMMON + FLOOR + grains(120))
        words = ["--set", "restart.every=5", "--set", "output.record_every=0"]
        self.run_ranks(2, deck, *words, "--set", "time.steps=20", output="small/out")
        for ranks in (3, 1):
            with self.subTest(ranks=ranks):
                self.fill(small / "fill")
                done = self.run_ranks(ranks, deck, *words, "--restart", "small/out", code=5, output="small/out")
                self.assertEqual(done.stderr.count("error:"), 1, done.stderr)
                self.assertRegex(done.stderr, "restart_[ab].*cannot write|No space left on device")
                self.assertEqual(done.stdout, "")
                (small / "fill").unlink()
                self.run_ranks(2, deck, "--restart", "small/out", "--set", "time.steps=30", output="on")
                self.assertEqual(self.run_json("on")["steps"], 30)


class Stops(Ranks):
    def start(self, ranks, *words):
        """Start a run that would last for hours, and wait until it has written both its restart files."""
        every = [] if not self.has_hdf5() else ["--set", "restart.every=50"]
        program = subprocess.Popen(
            [self.launcher, "--oversubscribe", "-n", str(ranks), self.program, "run", self.deck(FALL),
             "--set", "time.steps=100000000", "--set", "output.record_every=20", "--quiet", "--output", "out", *every, *words],
            cwd=self.place, env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)  # fmt: skip
        self.addCleanup(program.stderr.close)
        self.addCleanup(program.kill)
        last = self.place / "out" / ("restart_b.h5" if every else "record.csv")
        end = time.monotonic() + self.timeout
        while not last.exists():
            self.assertLess(time.monotonic(), end, "nothing happens")
            time.sleep(0.02)
        return program

    def ranks_of(self, program):
        """Process numbers of the ranks that a launcher has started."""
        names = Path(f"/proc/{program.pid}/task/{program.pid}/children").read_text().split()
        return [int(name) for name in names if Path(f"/proc/{name}/comm").read_text().strip() == Path(self.program).name[:15]]

    def test_a_rank_that_is_killed_takes_the_others_with_it(self):
        program = self.start(3)
        ranks = self.ranks_of(program)
        self.assertEqual(len(ranks), 3)
        os.kill(ranks[1], signal.SIGKILL)
        self.assertEqual(program.wait(self.timeout), 128 + signal.SIGKILL)
        self.assertIn("exited on signal 9", program.stderr.read())
        for rank in ranks:
            self.assertFalse(Path(f"/proc/{rank}/exe").exists(), "a rank goes on")
        if not self.has_hdf5():
            return
        for ranks in (2, 4, 1):
            self.run_ranks(ranks, "deck.toml", "--restart", "out", "--walltime", "0.2", "--set", "time.steps=100000000", code=75)
            self.assertTrue(all(math.isfinite(float(row["kinetic_energy"])) for row in self.rows()))
            steps = [int(row["step"]) for row in self.rows()]
            self.assertEqual(steps, sorted(set(steps)))

    def test_a_signal_to_one_rank_stops_all_with_a_checkpoint(self):
        program = self.start(3)
        os.kill(self.ranks_of(program)[2], signal.SIGTERM)
        self.assertEqual(program.wait(self.timeout), 75)
        run = self.run_json()
        self.assertEqual((run["status"], run["reason"]), ("stopped", f"stopped by signal 15 after step {run['steps']}"))
        if self.has_hdf5():
            self.run_ranks(2, "deck.toml", "--restart", "out", "--set", f"time.steps={run['steps'] + 1}")
            self.assertEqual(self.run_json()["steps"], run["steps"] + 1)

    def test_a_signal_to_the_launcher_stops_all_with_a_checkpoint(self):
        program = self.start(2)
        program.send_signal(signal.SIGTERM)
        # Its exit code is the launcher's own.
        self.assertNotEqual(program.wait(self.timeout), 0)
        self.assertEqual(self.run_json()["status"], "stopped")

    def test_walltime(self):
        deck = self.deck(FALL)
        words = ["--set", "time.steps=100000000", "--set", "output.record_every=0", "--walltime", "0.5"]
        done = self.run_ranks(3, deck, *words, code=75)
        self.assertEqual(done.stdout, "")
        run = self.run_json()
        self.assertEqual((run["status"], run["reason"]), ("stopped", f"stopped by the walltime after step {run['steps']}"))
        if self.has_hdf5():
            self.run_ranks(2, deck, "--restart", "out", "--set", f"time.steps={run['steps'] + 1}")


class Once(Ranks):
    def test_what_needs_no_ranks_is_done_by_one(self):
        good = self.deck(FALL)
        self.deck(FALL.replace("friction =", "frction ="), "bad.toml")
        for code, *words in (
            (0, "--help"),
            (0, "run", "--help"),
            (0, "--version"),
            (0, "reference"),
            (0, "check", good),
            (2, "check", "bad.toml"),
            (0, "convert", good, "datbox"),
            (2, "convert", "nowhere.toml", "other"),
            (0, "partition", good, "--parts", "3"),
            (2, "solve", "nowhere.hdf5"),
            (2,),
        ):
            with self.subTest(words=words):
                alone = self.run_program(*words, code=code)
                shutil.rmtree(self.place / "datbox", ignore_errors=True)
                done = self.launch((3, *words), code=code)
                self.assertEqual(done.stdout, alone.stdout)
                # The launcher has something to say of exit codes, too.
                self.assertEqual([done.stderr.count(line) for line in alone.stderr.splitlines()],
                                 [alone.stderr.count(line) for line in alone.stderr.splitlines()])  # fmt: skip

    def test_ranks_with_different_commands(self):
        good = self.deck(FALL)
        done = self.launch((1, "run", good, "--quiet"), (1, "check", good), code=2)
        self.assertEqual(done.stderr.count("each of them was given another command"), 1, done.stderr)


class Log(Ranks):
    def test_pictures_are_not_compressed_and_this_is_said_once(self):
        if not self.has_hdf5():
            self.skipTest("built without HDF5")
        deck = self.deck(FALL)
        words = ["--set", "output.every=30", "--set", "output.compression=true"]
        said = [self.run_ranks(ranks, deck, *words).stderr.count("pictures uncompressed") for ranks in (1, 3)]
        self.assertEqual(said, [0, 1])

    def test_said_once(self):
        printed = self.launch((4, "run", self.deck(PRESSED))).stdout
        lines = [line for line in printed.splitlines() if line.strip()]
        self.assertEqual(len(lines), len(set(lines)), printed)
        for said in ("scene      64 bodies", "ranks      4, split by boxes, glued by dual", "done: 60 of 60 steps",
                     "  ranks  ", "  gluing  "):  # fmt: skip
            self.assertEqual(printed.count(said), 1, f"{said}\n{printed}")
        # No number has gone astray.
        self.assertIsNone(re.search(r"nan|inf\b|\*\*", printed, re.I), printed)
        self.assertEqual(self.run_json("deck.results")["ranks"], 4)


if __name__ == "__main__":
    take_program()
    Ranks.launcher = sys.argv.pop(1) if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else ""
    printed = subprocess.run([ProgramCase.program, "--version"], capture_output=True, text=True, timeout=60).stdout
    if not Ranks.launcher or re.search(r"^MPI +off", printed, re.M):
        print("skipped: the program has no MPI, or there is no mpiexec\n0 passed, 0 failed")
        sys.exit(0)
    outcome = unittest.main(exit=False).result
    failed = len(outcome.failures) + len(outcome.errors)
    print(f"{outcome.testsRun - failed} passed, {failed} failed")
    sys.exit(failed > 0 or outcome.testsRun == 0)
