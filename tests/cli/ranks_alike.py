"""One rank under a launcher is a run without it, and several ranks find what one does. Where other cases run on ranks already,
subdomains of one process (`partition.parts`) replace them: their numbers are those of ranks, digit by digit."""

import csv
import re
import subprocess
import time

from ranks_case import (BIG_GRAIN, BOX, CLUMPS, CLUSTERS, COMMON, DRIVES, FALL, FLOOR, GRAPH, PRESSED, SIDES, Ranks, grains,
                        grains_in_space)


class Alone(Ranks):
    def test_one_rank_is_the_run_without_launcher(self):
        deck = self.deck(PRESSED)
        words = ["run", deck, "--quiet", "--force"] + (["--set", "restart.every=60"] if self.has_hdf5() else [])
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

            # Of the datasets one may differ: among other sums of the run it holds times, some fifty numbers; so may check sums, of
            # it and of the heads, which hold when they were made.
            where = [i for i, (a, b) in enumerate(zip(*files)) if a != b and not is_stamp(i)]
            self.assertLess(len(where), 8 * 60)

    def test_one_rank_never_starts_mpi(self):
        # Open MPI lists its parameters when it starts, and no call but that may come before it starts.
        deck = self.deck(FALL)
        told = {"OMPI_MCA_mpi_show_mca_params": "all"}
        words = ["run", deck, "--quiet", "--force", "--set", "time.steps=3"]
        if "mpi_show_mca_params" not in "".join(self.launch((2, *words), environment=told).stderr):
            self.skipTest("this MPI does not tell that it starts")
        self.assertEqual(self.launch((1, *words), environment=told).stderr, "")
        done = subprocess.run([self.program, *words], cwd=self.place, env=dict(self.environment, **told), capture_output=True,
                              text=True, timeout=self.timeout)  # fmt: skip
        self.assertEqual((done.returncode, done.stderr), (0, ""))


class Shares(Ranks):
    def test_more_ranks_than_grains(self):
        kept = {"kinetic_energy": 1e-9, "potential_energy": 1.0, "contacts": 1.0, "compactness": 1.0}
        for name, ranks, text in (
            ("two grains", 3, COMMON + FLOOR + grains(2)),
            ("one grain", 2, COMMON + FLOOR + grains(1)),
            ("walls alone", 2, COMMON + FLOOR + SIDES),
        ):
            deck = self.deck(text.replace("steps = 60", "steps = 20"))
            self.run_ranks(1, deck, output="one")
            self.assertEqual(self.run_json("one")["contacts"] > 0, name != "walls alone")
            for words in ([], GRAPH) if self.has_library("METIS") else ([],):
                with self.subTest(name, words=words):
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
            ("clumps", COMMON + FLOOR + SIDES + CLUMPS + grains(40, 'shape = "clump"\nclump = ["pair", "half"]\n')),
            ("polygons", COMMON + FLOOR + SIDES + grains(40, 'shape = "polygon"\n')),
            ("a big grain among small ones", COMMON + FLOOR + SIDES + BIG_GRAIN + grains(60)),
            ("spheres", "[scene]\ndimension = 3\n" + COMMON + BOX + grains_in_space(60)),
            ("polyhedra", "[scene]\ndimension = 3\n" + COMMON + BOX + grains_in_space(40, 'shape = "polyhedron"\n')),
        ):
            if name == "polyhedra" and not self.has_library("Qhull"):
                continue
            with self.subTest(name):
                deck = self.deck(text)
                self.run_program("run", deck, "--quiet", "--force", "--output", "one")
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
                    ranks, parts = (3, 0) if criterion == "quad" else (1, 3)
                    self.run_ranks(ranks, deck, *words, "--set", f'partition.gluing="{gluing}"', *self.split(parts), output="many")
                    self.assertLess(self.run_json("many")["worst_e8"], 1e-5)
                    self.compare(self.run_json("one"), self.run_json("many"), 1e-5, kept)

    @staticmethod
    def split(parts):
        """Words for subdomains of one process; none for ranks."""
        return ["--set", f"partition.parts={parts}"] if parts else []

    def test_traces_are_of_the_whole_problem_and_change_nothing(self):
        """Ranks that trace have the rows of subdomains of one process that do not."""
        deck = self.deck(PRESSED)
        # Grains have come down, so that subdomains share contacts, and the last step is not one that is solved again.
        words = ["--set", "time.steps=60", "--set", "output.record_every=1"]
        for gluing in ("dual", "primal", "momentum"):
            with self.subTest(gluing):
                self.run_ranks(1, deck, *words, "--set", f'partition.gluing="{gluing}"', *self.split(3), output="silent")
                self.run_ranks(3, deck, *words, "--set", f'partition.gluing="{gluing}"', "--set", "report.trace=true",
                               "--set", "report.trace_steps=60", output="traced")
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
                for name in ("messages", "bytes", "collectives"):
                    counts = [int(point[name]) for point in points]
                    self.assertEqual(counts, sorted(counts), name)
                    self.assertGreater(counts[-1], counts[0], name)

    def test_messages_of_traces_are_those_of_the_run(self):
        deck = self.deck(PRESSED)
        # The grains fall for some 30 steps, which no sweep is for; then they are pressed.
        self.run_ranks(3, deck, "--set", "time.steps=60", "--set", "report.trace=true", "--set",
                       f"report.trace_steps={list(range(1, 61))}", output="traced")
        points = csv.DictReader((self.place / "traced/trace.csv").read_text().splitlines())
        traced = sum({point["step"]: int(point["bytes"]) for point in points}.values())
        run = self.run_json("traced")
        self.assertGreater(run["gluings"], 60)
        # The test that ends a step comes after its last point, and sends once more; one rank of three has less than half.
        self.assertLessEqual(traced, 1.000001 * run["bytes_per_gluing"] * run["gluings"])
        self.assertGreater(traced, 0.5 * run["bytes_per_gluing"] * run["gluings"])

    def test_a_wall_under_pressure_is_where_one_rank_has_it(self):
        if not self.has_hdf5():
            self.skipTest("built without HDF5")
        deck = self.deck(PRESSED)
        # Sweeps of a push end before it is solved as far as a step: of 3e-4 of a radius of 0.02 m that overlap may be deep, little
        # differs per layer (8e-6 m in all as measured).
        for recovery, within in ((0.0, 1e-6), (3e-4, 5e-5)):
            words = ["--set", "time.steps=100", "--set", "restart.every=100", "--set", "output.record_every=0", "--set",
                     f"time.recovery={recovery}"]
            self.run_ranks(1, deck, *words, output="one")
            one, contacts = self.state(deck, "one")
            (self.place / "state of one").rename(self.place / f"state of one, {recovery}")
            for gluing in ("dual", "primal", "momentum"):
                with self.subTest(gluing, recovery=recovery):
                    ranks, parts = (3, 0) if gluing == "dual" else (1, 3)
                    self.run_ranks(ranks, deck, *words, "--set", f'partition.gluing="{gluing}"', *self.split(parts), output="many")
                    self.assertEqual("recoveries" in self.run_json("many"), recovery > 0)
                    many, shared = self.state(deck, "many")
                    (self.place / "state of many").rename(self.place / f"state of many, {gluing}, {recovery}")
                    # The lid is the fourth body, and starts at 0.52 m.
                    self.assertLess(one[6 * 3 + 1], 0.51, "the lid does not move")
                    self.assertAlmostEqual(many[6 * 3 + 1], one[6 * 3 + 1], delta=within)
                    self.assertEqual(shared.keys(), contacts.keys())
