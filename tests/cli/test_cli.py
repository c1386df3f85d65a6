#!/usr/bin/env python3
"""Test the program from outside: commands, exit codes, files of results, signals, restart.

usage: test_cli.py PROGRAM [unittest options]
"""

import csv
import json
import re
import shutil
import signal
import subprocess
import sys
import time
import tomllib
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

SOURCE = Path(__file__).resolve().parents[2]

# Twelve disks fall on a floor.
DECK = """[time]
step = 1e-3
steps = 120
[solver]
tolerance = 1e-6
[[material]]
name = "sand"
density = 2600.0
[[law]]
friction = 0.3
[[wall]]
from = [-0.1, -0.01]
to = [0.5, -0.01]
thickness = 0.02
[[sample]]
box = [0.0, 0.0, 0.4, 0.3]
kind = "lattice"
count = 12
radius = [0.03, 0.04]
"""

# Names that scripts rely on.
RUN_KEYS = """steps time bodies contacts active_contacts converged_steps worst_e1 worst_e2 worst_e8 sweeps contact_updates
cpu_seconds cpu_predict cpu_detect cpu_assemble cpu_solve cpu_update wall_seconds kinetic_energy mean_velocity max_velocity
max_penetration volume_error compactness coordination energy_closure ranks bytes_per_contact peak_memory_bytes version
deck_hash""".split()
RECORD_COLUMNS = """step time contacts sweeps contact_updates e1 e2 e8 cpu_seconds wall_seconds kinetic_energy
potential_energy drive_work friction_loss impact_loss energy_closure mean_penetration max_penetration volume_error
compactness coordination coordination_without_rattlers single_contacts double_contacts triple_contacts mean_velocity
max_velocity inertia_number""".split()


class Cli(ProgramCase):
    def setUp(self):
        super().setUp()
        self.deck = self.place / "fall.toml"
        self.deck.write_text(DECK)

    def run_json(self, folder="fall.results"):
        return json.loads((self.place / folder / "run.json").read_text())

    def record(self, folder="fall.results"):
        with open(self.place / folder / "record.csv", newline="") as file:
            return list(csv.DictReader(file))

    def restart_files(self, folder):
        return sorted(p.name for p in (self.place / folder).iterdir() if "restart" in p.name)


class Commands(Cli):
    def test_version_names_compiler_and_libraries(self):
        printed = self.run_program("--version").stdout
        for word in ("splitgrain", "commit", "compiler", "flags", "MPI", "HDF5", "METIS", "FFTW", "UMFPACK", "Qhull", "LAPACK"):
            self.assertIn(word, printed)

    def test_help_everywhere(self):
        for command in ("run", "check", "reference", "convert", "bench", "partition", "solve", "spectrum"):
            self.assertIn(command, self.run_program(command, "--help").stdout)
        self.assertIn("run DECK", self.run_program("--help").stdout)

    def test_exit_codes_are_told_wherever_they_are_listed(self):
        """Those of the source, in the help of `run` and in the README."""
        codes = set(re.findall(r":: exit_\w+ = (\d+)", (SOURCE / "src/base/error.f90").read_text()))
        said = self.run_program("run", "--help").stdout.partition("Exit codes:")[2]
        self.assertEqual(set(re.findall(r"\b\d+(?= )", said)), codes)
        table = (SOURCE / "README.md").read_text().partition("### Exit codes")[2].partition("##")[0]
        self.assertEqual(set(re.findall(r"^\| (\d+) ", table, re.M)), codes)

    def test_mistakes_of_the_command_line(self):
        for words, said in (
            (["rnu", "fall.toml"], 'did you mean "run"'),
            (["run"], "run DECK"),
            (["run", "nowhere.toml"], "nowhere.toml"),
            (["run", "fall.toml", "--outptu", "x"], "outptu"),
            (["run", "fall.toml", "--walltime", "soon"], "walltime"),
            (["run", "fall.toml", "--set", "solver.tolerence=1"], 'did you mean "tolerance"'),
            (["run", "fall.toml", "--set", "time.steps=many"], "steps"),
            (["run", "fall.toml", "--set", "time.steps=99999999999999999999"], "too large"),
            (["run", "fall.toml", "--set", "law[1.0].friction=1"], "counted from 1"),
            (["run", "fall.toml", "--output", "--quiet"], "not the option --quiet"),
            (["run", "fall.toml", "--"], "unknown option"),
            (["partition", "fall.toml", "--boxes", "2x"], "two or three numbers"),
        ):
            with self.subTest(words=words):
                self.assertIn(said, self.run_program(*words, code=2).stderr)

    def test_reference_in_the_documentation_is_that_of_the_program(self):
        self.assertEqual(self.run_program("reference").stdout, (SOURCE / "doc/deck_reference.md").read_text())


# Decks of thousands of bodies: with sanitizers they take a third of the time of all decks.
CROWDS = ["decomposition/long_box.toml", "talk/tamping.toml", "talk/ballast/sample.toml", "talk/ballast/tamping.toml"]


class Decks(Cli):
    def test_unknown_key_is_shown_with_a_caret(self):
        self.deck.write_text(DECK.replace("friction =", "frction ="))
        for command in ("check", "run"):
            said = self.run_program(command, "fall.toml", code=2).stderr
            self.assertRegex(said, r'fall\.toml:10:1: error: unknown key "frction" in \[\[law\]\]; did you mean "friction"\?')
            self.assertIn("  frction = 0.3\n  ^", said)
        self.assertFalse((self.place / "fall.results").exists())

    def test_all_mistakes_at_once(self):
        self.deck.write_text(DECK.replace("step = 1e-3", "step = 0.0").replace("2600.0", '"heavy"'))
        said = self.run_program("check", "fall.toml", code=2).stderr
        self.assertIn("fall.toml:2:", said)
        self.assertIn("fall.toml:8:", said)

    def test_title_and_purpose_are_kept(self):
        """In the log, in run.json and in the effective deck; the hash is that of the deck without them."""
        plain = re.search(r"^deck +(\w+)", self.run_program("check", "fall.toml").stdout, re.M)[1]
        self.deck.write_text('title = "Twelve\\tdisks"\nabout = """\nFor "tests".\nTwo lines."""\n' + DECK)
        said = self.run_program("run", "fall.toml", "--set", "time.steps=1").stdout
        self.assertIn("title      Twelve disks\n", said)
        found = self.run_json()
        self.assertEqual((found["title"], found["about"]), ("Twelve disks", 'For "tests".\nTwo lines.'))
        effective = self.place / "fall.results" / "effective.toml"
        self.assertEqual(tomllib.loads(effective.read_text())["about"], 'For "tests".\nTwo lines.')
        said = self.run_program("check", "fall.toml", "--set", "title=Other words").stdout
        self.assertRegex(said, rf"title      Other words\ndeck +{plain}\n")
        self.deck.write_text("titel = 'x'\n" + DECK)
        self.assertIn('did you mean "title"?', self.run_program("check", "fall.toml", code=2).stderr)
        for wrong in ("title = 3", "about = ['x']", "[title]", "title.x = 1", "title = ''"):
            self.deck.write_text(f"{wrong}\n{DECK}")
            self.assertIn("fall.toml:1:", self.run_program("check", "fall.toml", code=2).stderr)

    def test_check_counts_without_running(self):
        printed = self.run_program("check", "fall.toml").stdout
        self.assertRegex(printed, r"13 bodies \(12 grains\)")
        self.assertIn("left out", printed)
        self.assertEqual([p.name for p in self.place.iterdir()], ["fall.toml"])

    def test_every_deck_of_the_project_is_whole_and_runs(self):
        # Studies are no decks: they have cases, or vary keys.
        decks = sorted(path for path in (SOURCE / "input_decks").rglob("*.toml")
                       if path.parent.name != "extreme" and not any(word in path.read_text() for word in ("[[case]]", "[[vary]]")))
        self.assertTrue(decks)
        crowds = [SOURCE / "input_decks" / name for name in CROWDS]
        self.assertLessEqual(set(crowds), set(decks))
        if "-fcheck" in self.run_program("--version").stdout:
            decks = [deck for deck in decks if deck not in crowds]
        # Pictures and checkpoints need HDF5; all else of a deck runs without.
        without = [] if self.has_hdf5() else ["--set", "output.every=0", "--set", "restart.every=0"]
        # `check` builds a scene as `run` does, which takes as long: only builds with all libraries do both, and not of large scenes.
        is_checked = re.search(r"^MPI\s+off", self.run_program("--version").stdout, re.M) is None
        for deck in decks:
            with self.subTest(deck=deck.name):
                text = deck.read_text()
                is_run = self.has_hdf5() or not any(block in text for block in ("[[stage]]", "[[field]]"))
                # Random polyhedra are hulls, spectra are transforms; a program without Qhull or FFTW must say so.
                needs = {'shape = "polyhedron"': "Qhull", "spectrum = true": "FFTW"}
                lacks = [library for words, library in needs.items() if words in text and not self.has_library(library)]
                words = ["run", deck, "--set", "time.steps=3", *without, "--output", deck.stem, "--quiet", "--force"]
                is_large = False
                if is_run and self.deck_ends_well(words, lacks):
                    found = self.run_json(deck.stem)
                    self.assertEqual(found["steps"], 3)
                    is_large = found["bodies"] > 1000
                if not is_run or is_checked and not is_large:
                    self.deck_ends_well(["check", deck], lacks)

    def deck_ends_well(self, words, lacks):
        """A command with a deck ends well, or says without which library it cannot; does it end well?"""
        done = subprocess.run([self.program, *words], cwd=self.place, capture_output=True, text=True, timeout=self.timeout)
        if done.returncode and lacks:
            self.assertIn(f"without {lacks[0]}", done.stderr)
        else:
            self.assertEqual(done.returncode, 0, done.stderr)
        return done.returncode == 0


class Dumps(Cli):
    def solve(self, *files):
        lines = self.run_program("solve", *files, "--json").stdout.splitlines()
        return [json.loads(line) for line in lines]

    def test_asked_for(self):
        if not self.has_library("HDF5"):
            said = self.run_program("run", "fall.toml", "--dump", "100", code=2).stderr
            self.assertIn("no HDF5", said)
            return
        self.run_program("run", "fall.toml", "--dump", "100,118-119")
        files = [f"fall.results/dump-{step}-{form}.hdf5" for step in (100, 118, 119) for form in ("local", "global")]
        solved = self.solve(*files)
        self.assertTrue(all(answer["converged"] for answer in solved))
        self.assertTrue(all(answer["contacts"] > 0 for answer in solved))
        self.assertEqual(self.run_json()["file_dump_119"], "dump-119-local.hdf5")

    def test_of_a_step_that_fails(self):
        if not self.has_library("HDF5"):
            self.skipTest("built without HDF5")
        few = ["--set", "solver.maximum_sweeps=1", "--set", "solver.check_every=1", "--set", "solver.stop_unconverged=true"]
        self.run_program("run", "fall.toml", *few, code=3)
        step = self.run_json()["steps"]
        answer, = self.solve(f"fall.results/dump-{step}-local.hdf5")
        self.assertTrue(answer["converged"])

    def test_bad_lists(self):
        for words in ("x", "0", "5-3", "1,,2", "-4"):
            self.assertIn("--dump", self.run_program("run", "fall.toml", f"--dump={words}", code=2).stderr)


class Partition(Cli):
    def partition(self, *words, deck=True):
        return json.loads(self.run_program("partition", *["fall.toml"][:deck], "--json", *words).stdout)

    def test_boxes_share_the_grains(self):
        split = self.partition("--parts", "4")
        self.assertEqual((split["method"], split["parts"], split["grains"]), ("boxes", 4, 12))
        self.assertEqual(split["boxes_x"] * split["boxes_y"], 4)
        self.assertEqual(sum(split[f"grains_in_{i}"] for i in range(1, 5) if f"grains_in_{i}" in split), 12)
        table = self.run_program("partition", "fall.toml", "--parts", "4").stdout
        self.assertEqual(sum(int(line.split()[1]) for line in table.splitlines()[-4:]), 12)

    def test_boxes_as_asked(self):
        split = self.partition("--boxes", "3x2")
        self.assertEqual((split["parts"], split["boxes_x"], split["boxes_y"], split["boxes_z"]), (6, 3, 2, 1))
        split = self.partition("--parts", "4", "--set", "partition.boxes=[0, 2]")
        self.assertEqual((split["boxes_x"], split["boxes_y"]), (2, 2))

    def test_pictures_and_restart(self):
        if not self.has_library("HDF5"):
            self.skipTest("built without HDF5")
        self.run_program("run", "fall.toml", "--quiet", "--set", "restart.every=120")
        split = self.partition("--parts", "3", "--restart", "fall.results", "--picture", "split")
        said = self.run_program("partition", "fall.toml", "--parts", "3", "--picture", "fall.results", code=2).stderr
        self.assertIn("fall.results: error: this folder holds results of a run", said)
        # All twelve have fallen on the floor.
        self.assertGreater(split["wall_contacts"], 0)
        for name in ("bodies", "shapes", "contacts"):
            self.assertTrue((self.place / "split" / f"{name}.vtkhdf").exists())

    def test_predicted_costs(self):
        told = self.partition("--lattice", "3000", "--parts", "3", "--predict", deck=False)
        self.assertGreater(told["contacts"], 0)
        for ranks in (1, 2, 3):
            # The slowest rank sweeps no less than the mean one.
            self.assertGreaterEqual(told[f"ranks_{ranks}_largest"] * ranks, told["contacts"])
            self.assertGreater(told[f"ranks_{ranks}_dual_seconds"], 0)
            self.assertGreater(told[f"ranks_{ranks}_primal_seconds"], 0)
        self.assertEqual((told["ranks_1_dual_efficiency"], told["ranks_1_dual_messages"]), (1, 0))
        slow = self.partition("--lattice", "3000", "--parts", "8", "--predict", "--latency", "1000000", deck=False)
        # Each message takes a second: a rank with most neighbours waits for them all.
        self.assertGreaterEqual(slow["ranks_8_dual_seconds"], slow["ranks_8_dual_neighbours"])
        table = self.run_program("partition", "--lattice", "3000", "--parts", "8", "--predict").stdout
        self.assertEqual([line.split()[0] for line in table.splitlines()[-4:]], ["1", "2", "4", "8"])

    def test_subdomains_of_the_deck(self):
        self.assertEqual(self.partition("--set", "partition.parts=4")["parts"], 4)
        self.assertEqual(self.partition("--set", "partition.parts=4", "--parts", "2")["parts"], 2)
        # Four subdomains are shared by at most four ranks; the split is the same for all of them, and one rank needs no message.
        costs = self.partition("--set", "partition.parts=4", "--parts", "8", "--predict")
        self.assertNotIn("ranks_8_largest", costs)
        shared = {costs[f"ranks_{ranks}_shared_grains"] for ranks in (1, 2, 4)}
        self.assertEqual(len(shared), 1)
        self.assertEqual(costs["ranks_1_dual_messages"], 0)
        self.assertEqual(costs["ranks_1_largest"], costs["contacts"])
        alone = self.partition("--parts", "4", "--predict")
        self.assertEqual(costs["ranks_4_shared_grains"], alone["ranks_4_shared_grains"])
        self.assertEqual(alone["ranks_1_shared_grains"], 0)

    def test_graph_needs_metis(self):
        if self.has_library("METIS"):
            self.assertEqual(self.partition("--parts", "3", "--method", "graph")["parts"], 3)
        else:
            said = self.run_program("partition", "fall.toml", "--parts", "3", "--method", "graph", code=2).stderr
            self.assertIn("without METIS", said)

    def test_mistakes(self):
        for words, said in (
            ([], "--parts"),
            (["--parts", "0"], "at least"),
            (["--parts", "13"], "12 grains, too few for 13 parts"),
            (["--parts", "2", "--method", "grpah"], "boxes or graph"),
            (["--parts", "4", "--boxes", "3x2"], "boxes 3 x 2 (0 for any number) cannot make 4 parts"),
            (["--boxes", "2x2x2"], "cannot make 8 parts of a scene in the plane"),
            (["--boxes", "2x0"], "how many parts"),
            (["--boxes", "2xx2"], "two or three numbers"),
            (["--boxes", "1x2x3x4"], "two or three numbers"),
            (["--boxes", "2x-1"], "two or three numbers"),
            (["--boxes", "2x2", "--method", "graph"], "boxes alone"),
            (["--parts", "2", "--restart", "nowhere"], "nowhere"),
            (["--parts", "2", "--predict", "--bandwidth", "0"], "above zero"),
            (["--parts", "13", "--predict"], "12 grains, too few for 13 parts"),
            (["--parts", "2", "--lattice", "3000"], "usage"),
            (["--parts", "2", "--set", "solver.tolerence=1"], 'did you mean "tolerance"'),
        ):
            with self.subTest(words=words):
                self.assertIn(said, self.run_program("partition", "fall.toml", *words, code=2).stderr)


class Runs(Cli):
    def test_a_run_writes_what_scripts_rely_on(self):
        printed = self.run_program("run", "fall.toml", "--set", "output.record_every=10").stdout
        self.assertIn("done: 120 of 120 steps", printed)
        run = self.run_json()
        self.assertEqual([key for key in RUN_KEYS if key not in run], [])
        self.assertEqual((run["status"], run["steps"], run["bodies"]), ("done", 120, 13))
        # Free fall and rest under a tolerance of 1e-6: hardly any overlap, and a balance closed to rounding.
        self.assertLess(run["worst_e8"], 1e-6)
        self.assertLess(run["energy_closure"], 1e-9)
        rows = self.record()
        self.assertEqual([int(row["step"]) for row in rows], list(range(10, 121, 10)))
        self.assertEqual([name for name in RECORD_COLUMNS if name not in rows[0]], [])

    def test_effective_deck_repeats_the_run(self):
        self.run_program("run", "fall.toml", "--set", "time.steps=40", "--output", "a", "--quiet")
        self.run_program("run", "a/effective.toml", "--output", "b", "--quiet")
        first, second = self.run_json("a"), self.run_json("b")
        self.assertEqual(second["steps"], 40)
        for key in ("deck_hash", "kinetic_energy", "contacts", "sweeps", "max_penetration"):
            self.assertEqual(first[key], second[key], key)

    def test_the_same_seed_gives_the_same_run(self):
        for folder in ("a", "b"):
            self.run_program("run", "fall.toml", "--output", folder, "--quiet")
        for row, same in zip(self.record("a"), self.record("b"), strict=True):
            for name in row:
                if "seconds" not in name and not name.startswith(("cpu_", "wall_")):
                    self.assertEqual(row[name], same[name], name)

    def test_a_bad_deck_speaks_for_itself_but_replaces_nothing_unasked(self):
        self.run_program("run", "fall.toml", "--quiet")
        self.assertEqual(self.run_json()["status"], "done")
        self.run_program("run", "fall.toml", "--set", "time.step=0", code=2)
        self.assertEqual(self.run_json()["status"], "done")
        self.run_program("run", "fall.toml", "--set", "time.step=0", "--force", code=2)
        self.assertEqual(self.run_json()["status"], "failed")
        self.assertIn("step", self.run_json()["reason"])

    def test_quiet_run_prints_nothing(self):
        self.assertEqual(self.run_program("run", "fall.toml", "--quiet").stdout, "")

    def test_run_that_does_not_converge_says_so(self):
        hard = ["--set", "solver.maximum_sweeps=1", "--set", "solver.tolerance=1e-14", "--set", "solver.check_every=1"]
        self.run_program("run", "fall.toml", *hard)
        self.assertGreater(self.run_json()["unconverged_steps"], 0)
        self.run_program("run", "fall.toml", *hard, "--set", "solver.stop_unconverged=true", "--force", code=3)
        self.assertEqual(self.run_json()["status"], "not converged")

    def test_spectrum_is_written_or_refused(self):
        words = ["run", "fall.toml", "--set", "report.spectrum=true"]
        if not self.has_library("FFTW"):
            self.assertIn("without FFTW", self.run_program(*words, code=2).stderr)
            return
        self.run_program(*words)
        self.assertEqual(self.run_json()["file_spectrum"], "spectrum.csv")
        rows = list(csv.DictReader((self.place / "fall.results/spectrum.csv").read_text().splitlines()))
        self.assertEqual(list(rows[0]), ["frequency_hz", "kinetic_energy", "wall_force_x", "wall_force_y", "momentum_x", "momentum_y"])
        self.assertEqual(len(rows), 120 // 2 + 1)
        self.assertAlmostEqual(float(rows[-1]["frequency_hz"]), 500.0)
        self.assertGreater(sum(float(row["wall_force_y"]) for row in rows), 0.0)
        self.run_program("run", "fall.toml", "--output", "silent")
        self.assertFalse((self.place / "silent/spectrum.csv").exists())

    def trace(self, folder, name="trace"):
        return list(csv.DictReader((self.place / folder / f"{name}.csv").read_text().splitlines()))

    def test_trace_follows_errors_and_changes_nothing(self):
        words = ["--set", "output.record_every=1", "--set", "solver.tolerance=1e-4"]
        for method in ("nlgs", "auto"):
            with self.subTest(method):
                more = [*words, "--set", f"solver.method={method}", "--force"]
                said = self.run_program("run", "fall.toml", *more, "--output", "silent").stdout
                self.assertNotIn("traced", said)
                self.assertFalse((self.place / "silent/trace.csv").exists())
                traced = ["--set", "report.trace=true", "--set", "report.trace_steps=[60, 110, 120, 500]"]
                said = self.run_program("run", "fall.toml", *more, *traced, "--output", "traced").stdout
                table = said[said.index("traced steps"):].splitlines()
                self.assertEqual([line.split()[0] for line in table[2:5]], ["60", "110", "120"])
                self.assertIn("1 to 120", table[5])
                rows = self.record("traced")
                for row, same in zip(rows, self.record("silent"), strict=True):
                    for name in row:
                        if "seconds" not in name and not name.startswith(("cpu_", "wall_")):
                            self.assertEqual(row[name], same[name], name)
                steps = self.trace("traced", "trace_steps")
                self.assertEqual([row["step"] for row in steps], ["60", "110", "120"])
                for step in steps:
                    self.check_trace(step, rows[int(step["step"]) - 1], self.trace("traced"))

    def check_trace(self, step, row, trace):
        """The history of a step begins at its start and ends with the errors recorded; effort rises."""
        for name in ("contacts", "sweeps", "contact_updates", "e1", "e2", "e8", "criterion", "time"):
            self.assertEqual(step[name], row[name], name)
        phases = sum(float(step[name]) for name in step if name.startswith("cpu_") and name != "cpu_seconds")
        self.assertAlmostEqual(float(step["cpu_seconds"]), phases, delta=1e-9)
        points = [point for point in trace if point["step"] == step["step"]]
        iterations = [int(point["iteration"]) for point in points]
        self.assertEqual((iterations[0], iterations), (0, sorted(iterations)))
        for name in ("cpu_seconds", "contact_updates"):
            self.assertEqual([float(point[name]) for point in points], sorted(float(point[name]) for point in points))
        self.assertEqual(points[-1]["contact_updates"], row["contact_updates"])
        for name in ("e1", "e2", "e8"):
            # Solvers of matrices sum in another order.
            self.assertAlmostEqual(float(points[-1][name]), float(row[name]), delta=1e-6 * float(row[name]) + 1e-15)

    def test_trace_goes_on_after_a_restart(self):
        if not self.has_hdf5():
            self.skipTest("built without HDF5")
        words = ["--set", "report.trace=true", "--set", "restart.every=50", "--output", "out", "--quiet"]
        self.run_program("run", "fall.toml", *words)
        steps, points = self.trace("out", "trace_steps"), self.trace("out")
        self.assertEqual([int(row["step"]) for row in steps], [15, 30, 45, 60, 75, 90, 105, 120])
        self.run_program("run", "fall.toml", *words, "--restart", "out")
        for rows, again in ((steps, self.trace("out", "trace_steps")), (points, self.trace("out"))):
            for row, other in zip(rows, again, strict=True):
                self.assertEqual([row[name] for name in row if "cpu" not in name], [other[name] for name in row if "cpu" not in name])

    def test_structure_is_written_or_refused(self):
        words = ["run", "fall.toml", "--set", "report.structure=true", "--set", "report.structure_every=50"]
        if not self.has_library("FFTW"):
            self.assertIn("without FFTW", self.run_program(*words, code=2).stderr)
            return
        self.run_program(*words)
        self.assertEqual(self.run_json()["file_structure_factor"], "structure_factor.csv")
        for name, column in (("radial_distribution", "g"), ("structure_factor", "s")):
            rows = list(csv.DictReader((self.place / f"fall.results/{name}.csv").read_text().splitlines()))
            # A deck of few grains: its lines may be none, its columns stand.
            self.assertTrue(all(float(row[column]) >= 0 for row in rows))
            self.assertLessEqual({row["step"] for row in rows}, {"50", "100", "120"})
        message = self.run_program("run", "fall.toml", "--set", "report.structure_box=[1, 0, 0, 1]", code=2).stderr
        self.assertIn("least, then its largest", message)

    def test_results_that_cannot_be_written(self):
        (self.place / "taken").write_text("a file, no folder")
        self.assertIn("taken", self.run_program("run", "fall.toml", "--output", "taken", code=5).stderr)
        (self.place / "out" / "record.csv").mkdir(parents=True)
        self.assertIn("record.csv", self.run_program("run", "fall.toml", "--output", "out", "--force", code=5).stderr)
        run = self.run_json("out")
        self.assertEqual(run["status"], "failed")
        self.assertIn("record.csv", run["reason"])


class Stops(Cli):
    def start(self, *words):
        """Start a run that would last for hours, and wait for its first rows."""
        program = subprocess.Popen(
            [self.program, "run", "fall.toml", "--set", "time.steps=100000000", "--set", "output.record_every=100",
             "--output", "out", "--quiet", *words],
            cwd=self.place, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)  # fmt: skip
        self.addCleanup(program.stderr.close)
        self.addCleanup(program.kill)
        self.wait_for(lambda: self.rows() >= 2)
        return program

    def rows(self):
        path = self.place / "out" / "record.csv"
        return path.read_text().count("\n") if path.exists() else 0

    def wait_for(self, holds):
        end = time.monotonic() + 60
        while not holds():
            self.assertLess(time.monotonic(), end, "nothing happens")
            time.sleep(0.02)

    def test_signals_end_the_run_with_a_checkpoint(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            with self.subTest(signal=number.name):
                program = self.start()
                program.send_signal(number)
                self.assertEqual(program.wait(60), 75)
                self.assertEqual(self.run_json("out")["status"], "stopped")
                if self.has_hdf5():
                    self.assertTrue(self.restart_files("out"))
                shutil.rmtree(self.place / "out")

    def test_walltime_ends_the_run(self):
        self.run_until_walltime(self.run_program, "run", "fall.toml", "--set", "time.steps=100000000",
                                "--set", "output.record_every=0", "--quiet")  # fmt: skip
        run = self.run_json()
        self.assertEqual(run["status"], "stopped")
        self.assertGreater(run["steps"], 0)
        self.assertFalse((self.place / "fall.results" / "record.csv").exists(), "a record that was not wanted")

    def test_checkpoint_on_request_and_on_with_the_run(self):
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        program = self.start()
        program.send_signal(signal.SIGUSR1)
        self.wait_for(lambda: self.restart_files("out"))
        rows = self.rows()
        self.wait_for(lambda: self.rows() > rows)
        self.assertIsNone(program.poll())
        program.kill()
        program.wait(60)

    def test_a_state_goes_on_from_a_datbox(self):
        if not self.has_hdf5():
            self.skipTest("no HDF5 in this build")
        quiet = ["--set", "restart.every=60", "--set", "output.record_every=1", "--quiet"]
        self.run_program("run", "fall.toml", "--set", "time.steps=60", "--output", "first", *quiet)
        self.run_program("convert", "fall.toml", "state", "--restart", "first")
        self.run_program("run", "fall.toml", "--set", "time.steps=61", "--restart", "first", "--output", "on", *quiet)
        deck = '[scene]\ndatbox = "state"\n[time]\nstep = 1e-3\nsteps = 1\n[solver]\ntolerance = 1e-6\n'
        (self.place / "datbox.toml").write_text(deck)
        self.run_program("run", "datbox.toml", "--quiet")
        on, again = self.run_json("on"), self.run_json("datbox.results")
        self.assertEqual(on["contacts"], again["contacts"])
        # A DATBOX holds seven digits.
        self.assertLess(abs(on["kinetic_energy"] - again["kinetic_energy"]), 1e-5 * abs(on["kinetic_energy"]))

    def test_restarted_run_is_the_straight_one(self):
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        every = ["--set", "restart.every=50", "--quiet"]
        self.run_program("run", "fall.toml", "--output", "straight", *every)
        self.run_program("run", "fall.toml", "--output", "halves", "--set", "time.steps=50", *every)
        self.run_program("run", "fall.toml", "--output", "halves", "--restart", "halves", *every)
        straight, halves = self.run_json("straight"), self.run_json("halves")
        for key in ("time", "contacts", "kinetic_energy", "potential_energy", "max_penetration", "friction_loss"):
            self.assertEqual(straight[key], halves[key], key)
        self.assertEqual([row["step"] for row in self.record("straight")], [row["step"] for row in self.record("halves")])


if __name__ == "__main__":
    take_program()
    unittest.main()
