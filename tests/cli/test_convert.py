#!/usr/bin/env python3
"""A DATBOX to a deck, from outside: what COMMAND.DAT, POSTPRO.DAT and a script give, and the table of the guide.

usage: test_convert.py PROGRAM [unittest options]
"""

import re
import subprocess
import sys
import tomllib
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "decks"))
from compare_lmgc90 import shared_decks  # noqa: E402
from lmgc90_reference import read_references  # noqa: E402
from program_case import ProgramCase, take_program  # noqa: E402
from test_cli import DECK  # noqa: E402

SOURCE = Path(__file__).resolve().parents[2]

COMMAND = """\
#COMMAND.DAT
TIME STEP                     :
2.D-04                        :
THETA                         :
0.55D0                        :
PERIODIC CONDITION            :
1.1                           :
loading step                  : label
INCREMENT STEP                :
REPETE 3 FOIS                 : a loop within the step
DEPUIS >more                  :
REPETE 3999 FOIS              :
DEPUIS loading step           :
SUB Signorini Coulomb         :
NLGS CHECK TYPE               :
QM/16 0.1666D-02              : Maxm,Quad,QM/16
0.9D0                         : RELAX
>more                         :
"""
POSTPRO = """\
#23456789012345678901234567890:
SOLVER INFORMATIONS           :
STEP 4                        :
BODY TRACKING                 :
STEP 2                        :
2                             :
2                             :
1                             :
NEW RIGID SETS                :
STEP 6                        :
2                             : sets
1                             : size
2                             :
2                             : size
1                             :
3                             :
DOUBLET INTERACTIONS          :
STEP 1                        :
DKDKx
      1
      3
DOUBLETS TORQUE EVOLUTION     :
STEP 8                        :
      3                       : pairs
      3       1               : as above
      2       3
      2      99               : no such body
SNAPSHOT SAMPLE               :
STEP 50                       :
THERMAL EVOLUTION             :
STEP 1                        :
END                           :
"""
SCRIPT = """\
from pylmgc90 import chipy
from pylmgc90.chipy import *
dt, theta = 1e-3, 0.6
T = 0.25
norm = 'Maxm '
def step():
    chipy.IncrementStep()
    chipy.ExSolver('Stored_Delassus_Loops         ', norm, 1e-5, 1.0, 20, 100)
    chipy.WriteDisplayFiles(freq=10)
chipy.SetDimension(2, 1)
chipy.TimeEvolution_SetTimeStep(dt)
chipy.Integrator_InitTheta(theta)
RBDY2_SetInvisible(3)
for k in range(1, int(T / dt) + 1):
    step()
raise SystemExit(open('ran', 'w'))
"""


class Convert(ProgramCase):
    def setUp(self):
        super().setUp()
        (self.place / "fall.toml").write_text(DECK)
        self.run_program("convert", "fall.toml", "DATBOX")

    def converted(self, *words):
        """The deck of the folder, which the program must find without mistakes, and what was printed."""
        done = self.run_program("convert", "DATBOX", "deck.toml", *words)
        deck = tomllib.loads((self.place / "deck.toml").read_text())
        self.run_program("check", "deck.toml")
        return deck, done.stderr

    def test_a_folder_alone(self):
        deck, printed = self.converted()
        self.assertEqual(deck["time"], {"step": 1e-3, "steps": 1000, "theta": 0.5})
        self.assertNotIn("POSTPRO", printed)
        self.assertEqual((self.place / "deck.toml").read_text().count("found nowhere"), 3)

    def test_command_file(self):
        (self.place / "DATBOX" / "COMMAND.DAT").write_text(COMMAND)
        deck, _ = self.converted()
        self.assertEqual(deck["time"], {"step": 2e-4, "steps": 4000, "theta": 0.55})
        self.assertEqual(deck["scene"]["period_x"], 1.1)
        self.assertEqual(deck["solver"], {"method": "nlgs", "criterion": "qm16", "tolerance": 1.666e-3, "relaxation": 0.9})
        self.assertIn("steps = 4000  # COMMAND.DAT:12", (self.place / "deck.toml").read_text())

    def test_nonsense_in_a_command_file_gives_no_key(self):
        (self.place / "DATBOX" / "COMMAND.DAT").write_text(
            "TIME STEP\nsoon\nTHETA\nNLGS CHECK TYPE\nNorm 1.0\nREPETE x FOIS\nINCREMENT STEP\nREPETE 9 FOIS\nDEPUIS nowhere\nTHETA")
        deck, _ = self.converted()
        self.assertEqual(deck["time"], {"step": 1e-3, "steps": 1000, "theta": 0.5})
        self.assertNotIn("solver", deck)

    def test_postpro_file(self):
        (self.place / "DATBOX" / "POSTPRO.DAT").write_text(POSTPRO)
        deck, printed = self.converted()
        self.assertEqual(deck["output"], {"every": 50, "record_every": 1})
        self.assertEqual([block["body"] for block in deck["track"]], [2, 1, 3])
        self.assertEqual([block["between"] for block in deck["interface"]], [[1, 3], [2, 3]])
        self.assertEqual(printed.count("POSTPRO.DAT: warning"), 1)
        self.assertRegex(printed, r"in record\.csv: SOLVER INFORMATIONS; in tracks\.csv \(\[\[track\]\]\): BODY TRACKING, NEW RIGID SETS; "
                                  r"in interfaces\.csv \(\[\[interface\]\]\): DOUBLET INTERACTIONS, DOUBLETS TORQUE EVOLUTION; "
                                  r"in pictures \(\[output\] every\): SNAPSHOT SAMPLE; nowhere: THERMAL EVOLUTION\n")
        # Pictures need HDF5.
        printed = self.run_program("run", "deck.toml", "--quiet", "--set", "time.steps=1", "--set", "output.every=0").stderr
        self.assertEqual(printed.count("POSTPRO.DAT"), 1)

    def test_settings_go_into_the_deck(self):
        deck, _ = self.converted("--set", "time.steps=7", "--set", "solver.criterion=e2", "--set", "guard.energy=warn # as ours")
        self.assertEqual((deck["time"]["steps"], deck["solver"], deck["guard"]), (7, {"criterion": "e2"}, {"energy": "warn"}))
        (self.place / "deck.toml").unlink()
        self.assertIn("not of the form", self.run_program("convert", "DATBOX", "deck.toml", "--set", "steps=7", code=2).stderr)

    def test_script_is_read_and_not_run(self):
        (self.place / "DATBOX" / "COMMAND.DAT").write_text(COMMAND)
        (self.place / "command.py").write_text(SCRIPT)
        tried = subprocess.run([self.program, "study", "nowhere.toml"], cwd=self.place, capture_output=True, text=True)
        if "and none was found" in tried.stderr:
            self.skipTest("no Python with what the package needs")
        deck, printed = self.converted()
        self.assertEqual(deck["time"], {"step": 1e-3, "steps": 250, "theta": 0.6})
        self.assertEqual(deck["solver"], {"method": "nlgs", "criterion": "maxm", "tolerance": 1e-5, "relaxation": 1.0, "check_every": 20,
                                          "maximum_sweeps": 2000})
        self.assertEqual((deck["output"], deck["scene"]["period_x"]), ({"every": 10}, 1.1))
        self.assertIn("step = 0.001  # command.py:11", (self.place / "deck.toml").read_text())
        self.assertIn("command.py:13:1: warning: RBDY2_SetInvisible is not carried over\n  RBDY2_SetInvisible(3)\n  ^\n", printed)
        self.assertFalse((self.place / "ran").exists())
        (self.place / "deck.toml").unlink()
        deck, _ = self.converted("--script", "none")
        self.assertEqual(deck["time"]["step"], 2e-4)
        (self.place / "deck.toml").unlink()
        (self.place / "old.py").write_text("print 'Python 2'\n")
        refused = self.run_program("convert", "DATBOX", "deck.toml", "--script", "old.py", code=2).stderr
        self.assertIn("old.py:1:1: error: this is not Python 3", refused)
        self.assertIn("cannot read", self.run_program("convert", "DATBOX", "deck.toml", "--script", "no.py", code=2).stderr)

    def test_table_of_the_guide(self):
        """Each command of the table in the guide has the counterpart that the program reports, and the columns named there exist."""
        guide = (SOURCE / "doc/guide/datbox.md").read_text().partition("## POSTPRO.DAT")[2].partition("\n## ")[0]
        rows = re.findall(r"^\| `([^`]+)` \| (record\.csv|tracks\.csv|interfaces\.csv|pictures|nothing) \| (.*) \|$", guide, re.M)
        self.assertGreaterEqual(len(rows), 44)
        clauses = {"record.csv": "in record.csv", "tracks.csv": "in tracks.csv ([[track]])",
                   "interfaces.csv": "in interfaces.csv ([[interface]])", "pictures": "in pictures ([output] every)", "nothing": "nowhere"}
        (self.place / "DATBOX" / "POSTPRO.DAT").write_text("".join(f"{name}\nSTEP 1\n" for name, _, _ in rows) + "END\n")
        _, printed = self.converted()
        line = next(line for line in printed.splitlines() if "POSTPRO.DAT: warning" in line)
        found = dict(clause.split(": ", 1) for clause in line.partition("; ")[2].split("; "))
        self.assertEqual(found, {clause: ", ".join(name for name, place, _ in rows if place == key) for key, clause in clauses.items()})
        source = (SOURCE / "src/datbox/read/datbox_postpro.f90").read_text().partition("contains")[0]
        self.assertLessEqual(set(re.findall(r"'([^',&\n]{9,})'", source)) - {"interface"}, {name for name, _, _ in rows})
        named = set(re.findall(r"`([a-z_0-9]+)`", " ".join(row[2] for row in rows)))
        pages = "".join((SOURCE / "doc/guide" / name).read_text() for name in ("results.md", "tracks.md", "files.md", "interfaces.md"))
        self.assertEqual({name for name in named if f"`{name}`" not in pages}, set())

    def test_real_folders(self):
        """COMMAND.DAT of LMGC90's own examples: theta and time step of the runs that their references hold."""
        decks = shared_decks()
        if decks is None:
            self.skipTest("no decks of LMGC90 in ${SPLITGRAIN_SHARED} or ../shared")
        for folder in sorted(decks.glob("*/DATBOX")):
            with self.subTest(folder=folder.parent.name):
                (self.place / "deck.toml").unlink(missing_ok=True)
                self.run_program("convert", folder, "deck.toml")
                deck = tomllib.loads((self.place / "deck.toml").read_text())
                self.run_program("check", "deck.toml")
                has_command = (folder / "COMMAND.DAT").exists()
                self.assertEqual("solver" in deck, has_command)
                try:
                    reference = read_references(folder.parent / "reference.txt")[0].parameters
                except (OSError, IndexError, TypeError, ValueError):
                    continue
                # WallPL_GroundJC was run by its newer script, which has other steps.
                if has_command and folder.parent.name != "WallPL_GroundJC":
                    self.assertEqual([deck["time"][key] for key in ("step", "theta")],
                                     [reference[f"time.{key}"] for key in ("step", "theta")])


if __name__ == "__main__":
    take_program()
    unittest.main()
