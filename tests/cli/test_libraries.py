#!/usr/bin/env python3
"""Test which libraries a run has in memory, by the trace of the dynamic loader: those that its deck asks for, and no others.

usage: test_libraries.py PROGRAM [MPIEXEC [unittest options]]
"""

import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

# Libraries that are opened on demand, and those that come with them; words of their file names.
ON_DEMAND = {
    "METIS": "metis",
    "FFTW": "fftw3",
    "UMFPACK": "umfpack|cholmod|amd|camd|colamd|ccolamd|suitesparseconfig",
    "Qhull": "qhull",
    "LAPACK": "lapack|blas|openblas",
    "MPI plugins": "mca_",
}

COMMON = """[time]
step = 2e-3
steps = 60
[[material]]
name = "stone"
density = 2600.0
[[law]]
friction = 0.3
"""
FLOOR = """[[wall]]
from = [-0.1, -0.01]
to = [0.5, -0.01]
thickness = 0.02
"""


def sample(shape, box, more=""):
    return f'[[sample]]\nshape = "{shape}"\nbox = {box}\nkind = "lattice"\ncount = 12\nradius = [0.03, 0.04]\n{more}'


DISKS = COMMON + FLOOR + sample("disk", [0.0, 0.0, 0.4, 0.3])
POLYGONS = COMMON + FLOOR + sample("polygon", [0.0, 0.0, 0.4, 0.3])
IN_SPACE = COMMON.replace("[time]", "[scene]\ndimension = 3\n[time]") + "[[container]]\nsize = [0.3, 0.3, 0.5]\n"
LINEAR = COMMON.replace("friction = 0.3", 'kind = "LINEAR"\nepsilon = 0.1\n[[interaction]]\nalert = 0.05')
SQUARE = LINEAR + sample("disk", [0.0, 0.0, 0.4, 0.3])
SPHERES = IN_SPACE + sample("sphere", [0.0, 0.0, 0.0, 0.3, 0.3, 0.5])
POLYHEDRA = IN_SPACE + sample("polyhedron", [0.0, 0.0, 0.0, 0.3, 0.3, 0.5])


class Libraries(ProgramCase):
    def setUp(self):
        super().setUp()
        if not self.trace([self.program, "--version"]):
            self.skipTest("the dynamic loader writes no trace")

    def trace(self, words):
        """Names of the files whose initial procedures the loader calls for any process of a command."""
        for old in self.place.glob("loader.*"):
            old.unlink()
        environment = dict(os.environ, LD_DEBUG="files", LD_DEBUG_OUTPUT=str(self.place / "loader"),
                           OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")  # fmt: skip
        environment.pop("TMPDIR", None)
        done = subprocess.run(list(map(str, words)), cwd=self.place, env=environment, capture_output=True, text=True,
                              timeout=self.timeout)  # fmt: skip
        self.assertEqual(done.returncode, 0, f"{words}\n{done.stdout}\n{done.stderr}")
        return {
            Path(name).name
            for file in self.place.glob("loader.*")
            for name in re.findall(r"calling init: (.*)", file.read_text(errors="replace"))
        }

    def loads(self, expected, *words, deck=None, ranks=0):
        """Which of the libraries on demand are in memory must be just these, as far as the program was built with them."""
        if deck:
            (self.place / "deck.toml").write_text(deck)
        launcher = [self.launcher, "--oversubscribe", "-n", ranks] if ranks else []
        names = self.trace([*launcher, self.program, *words])
        loaded = {
            library
            for library, pattern in ON_DEMAND.items()
            if any(re.match(rf"(lib)?({pattern})", name) for name in names)
        }
        if ranks:
            loaded.discard("MPI plugins")
        # CHOLMOD, which UMFPACK brings, brings LAPACK, and METIS on some systems.
        if "UMFPACK" in expected:
            loaded -= {"LAPACK", "METIS"}
        self.assertEqual(loaded, {library for library in expected if self.has_library(library)}, sorted(names))

    def test_what_needs_nothing_loads_nothing(self):
        self.loads([], "--version")
        for name, deck in (("disks", DISKS), ("polygons", POLYGONS), ("spheres", SPHERES),
                           ("no friction", DISKS.replace("friction = 0.3", "friction = 0.0"))):  # fmt: skip
            with self.subTest(name):
                self.loads([], "run", "deck.toml", "--quiet", "--force", deck=deck)
        self.loads([], "check", "deck.toml")
        self.loads([], "bench", "--contacts", "100", "--sweeps", "20")

    def test_spectra_load_fftw(self):
        if not self.has_library("FFTW"):
            self.skipTest("built without FFTW")
        self.loads(["FFTW"], "run", "deck.toml", "--quiet", "--force", "--set", "report.spectrum=true", deck=DISKS)

    def test_graphs_load_metis(self):
        if not self.has_library("METIS"):
            self.skipTest("built without METIS")
        self.loads([], "partition", "deck.toml", "--parts", "2", "--set", 'partition.split="boxes"', deck=DISKS)
        self.loads(["METIS"], "partition", "deck.toml", "--parts", "2", "--set", 'partition.split="graph"')

    def test_factors_load_umfpack(self):
        self.loads([], "run", "deck.toml", "--quiet", "--force", "--set", 'solver.method="accelerated"', deck=DISKS)
        self.loads(["UMFPACK"], "run", "deck.toml", "--quiet", "--force", "--set", 'solver.method="interior"')

    def test_hulls_load_qhull(self):
        if not self.has_library("Qhull"):
            self.skipTest("built without Qhull")
        self.loads(["Qhull"], "run", "deck.toml", "--quiet", "--force", deck=POLYHEDRA)

    def test_eigenvalues_load_lapack(self):
        if not self.has_library("LAPACK"):
            self.skipTest("built without LAPACK")
        self.loads(["LAPACK"], "spectrum", "deck.toml", "--parts", "2", deck=SQUARE)

    def test_ranks_load_metis_where_they_split_a_graph(self):
        if self.launcher is None:
            self.skipTest("no program that starts ranks")
        self.loads([], "run", "deck.toml", "--quiet", "--force", "--set", 'partition.split="boxes"', deck=DISKS, ranks=2)
        if self.has_library("METIS"):
            self.loads(["METIS"], "run", "deck.toml", "--quiet", "--force", "--set", 'partition.split="graph"', ranks=2)


if __name__ == "__main__":
    take_program()
    unittest.main()
