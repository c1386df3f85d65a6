#!/usr/bin/env python3
"""What `cmake --install` puts into a prefix, used from another folder: the program, pictures, a movie, manual, completion, links.

usage: test_installed.py PROGRAM [unittest options]
"""

import os
import re
import subprocess
import sys
import unittest
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

LINK = re.compile(r"\]\(([^()\s:#]+)(?:#[\w-]+)?\)")
DECK = """[scene]
gravity = [0.0, -10.0]
[time]
step = 1e-3
steps = 4
[output]
every = 2
[[material]]
name = "stone"
density = 1000.0
[[law]]
friction = 0.3
[[wall]]
from = [-1.0, -0.1]
to = [1.0, -0.1]
thickness = 0.2
material = "stone"
[[body]]
name = "ball"
shape = "disk"
radius = 0.1
position = [0.0, 0.1]
material = "stone"
"""
COMPLETE = """source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); compopt() { :; }
_splitgrain; printf '%s\\n' "${COMPREPLY[@]}"
"""


class Installed(ProgramCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = TemporaryDirectory()
        cls.prefix = Path(cls.folder.name) / "a prefix"
        words = ["cmake", "--install", str(Path(cls.program).parent), "--prefix", str(cls.prefix)]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        if done.returncode:
            raise AssertionError(done.stdout + done.stderr)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def start(self, *words):
        path = f"{self.prefix / 'bin'}:{os.environ['PATH']}"
        environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHONPATH", "SPLITGRAIN"))}
        return subprocess.run(list(map(str, words)), cwd=self.place, capture_output=True, text=True, timeout=self.timeout,
                              env={**environment, "PATH": path}, check=False)

    def complete(self, *words):
        script = self.prefix / "share/bash-completion/completions/splitgrain"
        done = self.start("bash", "-c", COMPLETE, "bash", script, "splitgrain", *words)
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    def test_run_and_pictures(self):
        (self.place / "ball.toml").write_text(DECK)
        without = () if self.has_hdf5() else ("--set", "output.every=0", "--set", "restart.at_end=false")
        done = self.start("splitgrain", "run", "ball.toml", "--quiet", *without)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        if without:
            self.skipTest("pictures need HDF5")
        # The sentence of the installed copy is another one: it is the one that is used.
        own = self.prefix / "share/splitgrain/postpro/splitgrain_postpro/command_line.py"
        own.write_text(own.read_text().replace("Draw the results", "Draw here the results"))
        done = self.start("splitgrain", "look", "scene", "ball.results")
        if "and none was found" in done.stderr:
            self.skipTest("no Python with h5py, matplotlib and numpy")
        self.assertEqual((done.returncode, done.stdout), (0, "wrote ball.results/scene.png\n"), done.stderr)
        done = self.start("splitgrain", "movie", "ball.results", "--output", "ball.gif", "--size", "100")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.place / "ball.gif").read_bytes()[:3], b"GIF")
        done = self.start("splitgrain", "look", "page", "ball.results")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("three.js authors", (self.place / "ball.results/page.html").read_text("utf-8"))
        licence = "share/splitgrain/postpro/splitgrain_postpro/vendor/three.LICENSE"
        self.assertIn("The MIT License", (self.prefix / licence).read_text("utf-8"))
        self.assertIn("Draw here", self.start("splitgrain", "look", "-h", "summary").stdout)
        self.assertIn("nowhere.toml", self.start("splitgrain", "study", "nowhere.toml").stderr)

    def test_commands_of_look_are_those_of_the_package(self):
        printed = self.start("splitgrain", "look", "--help").stdout
        code = (f"import sys; sys.path.insert(0, {str(self.prefix / 'share/splitgrain/postpro')!r}); "
                "from splitgrain_postpro.command_line import COMMANDS; print(*sorted(COMMANDS))")
        done = self.start("python3", "-P", "-c", code)
        self.assertEqual(sorted(printed.splitlines()[2].split()), done.stdout.split(), done.stderr)

    def test_completion(self):
        self.assertEqual(self.complete("par"), ["partition"])
        self.assertEqual(self.complete("look", "mo"), ["movie"])
        self.assertEqual(self.complete("run", "deck.toml", "--wall"), ["--walltime"])
        self.assertEqual(self.complete("run", "deck.toml", "--set", "time.st"), ["time.step=", "time.steps="])
        self.assertIn("nesterov", self.complete("run", "deck.toml", "--set", "solver.method", "=", "nes"))
        self.assertEqual(self.complete("run", "deck.toml", "--set", "restart.at_end", "="), ["true", "false"])
        self.assertEqual(self.complete("run", "de"), [])

    def test_manual(self):
        text = (self.prefix / "share/man/man1/splitgrain.1").read_text()
        self.assertIn(".SS partition\n", text)
        self.assertIn("\\-\\-walltime", text)
        self.assertFalse([line for line in text.splitlines() if re.match(r"\\&\s*-", line)])

    def test_links_of_the_pages(self):
        top = self.prefix / "share/doc/splitgrain"
        broken = [f"{page.relative_to(top)}: {link}" for page in top.rglob("*.md") for link in LINK.findall(page.read_text())
                  if not (page.parent / link).exists()]
        self.assertEqual(broken, [])
        self.assertTrue((top / "input_decks/collapsing_column.toml").is_file())


if __name__ == "__main__":
    take_program()
    unittest.main()
