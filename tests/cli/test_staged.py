#!/usr/bin/env python3
"""Stages of one deck, [[stage]]: closed forms, the same as runs by --restart, restarts within a stage, ranks, conditions, bad input.

usage: test_staged.py PROGRAM MPIEXEC [unittest options]
"""

import json
import re
import sys
import unittest
from math import ceil, pi
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

DECKS = Path(__file__).resolve().parents[2] / "input_decks"
HEAD = """[time]
step = 1e-3
{time}
[solver]
method = "nlgs"
criterion = "e8"
tolerance = 1e-12
[output]
record_every = 1
[scene]
dimension = {dimension}
gravity = {gravity}
[[material]]
name = "stone"
density = 1000.0
[[law]]
name = "rubbing"
friction = {friction}
[[track]]
body = "*"
"""
DISK = """[[wall]]
name = "floor"
from = [-1.0, -0.01]
to = [9.0, -0.01]
thickness = 0.02
[[body]]
name = "ball"
shape = "disk"
radius = 0.1
position = [0.0, 0.1]
velocity = [1.0, 0.0]
"""
SPHERE = """[[wall]]
name = "floor"
centre = [4.0, 0.0, 0.0]
normal = [0.0, 0.0, 1.0]
size = [12.0, 2.0]
thickness = 0.02
[[body]]
name = "ball"
shape = "sphere"
radius = 0.1
position = [0.0, 0.0, 0.1]
velocity = [1.0, 0.0, 0.0]
"""
PLATE = """[[body]]
name = "plate"
shape = "polygon"
vertices = [[-0.5, -0.1], [0.5, -0.1], [0.5, 0.1], [-0.5, 0.1]]
position = [0.0, 1.0]
"""
PACK = """[[wall]]
name = "floor"
from = [0.0, -0.01]
to = [0.6, -0.01]
thickness = 0.02
[[wall]]
name = "lid"
from = [0.0, 0.35]
to = [0.6, 0.35]
thickness = 0.02
[[pressure]]
body = "lid"
direction = [0.0, -1.0]
length = 0.6
value = 1e3
[[sample]]
kind = "lattice"
arrangement = "triangular"
box = [0.0, 0.0, 0.6, 0.33]
radius = [0.018, 0.024]
spacing = 1.02
"""
SHEAR = """[[stage.drive]]
body = "lid"
component = "x"
value = "0.3*min(1, t/0.01)"
"""
ROUNDING = 1e-12
"""Works and energies of some hundred steps, relative to the largest: rounding of each is 1e-16."""


def drive(component, value=0.0, more=""):
    value = f'"{value}"' if isinstance(value, str) else value
    return f'[[stage.drive]]\nbody = "plate"\ncomponent = "{component}"\nvalue = {value}\n{more}'


class Staged(ProgramCase):
    def setUp(self):
        super().setUp()
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints, from which stages go on")

    def write(self, body, stages, name="deck", gravity=(0.0, -10.0), friction=0.0, time=""):
        """A deck with stages, each a text; stages without the double bracket."""
        head = HEAD.format(dimension=len(gravity), gravity=list(gravity), friction=friction, time=time)
        (self.place / f"{name}.toml").write_text(head + body + "".join(f"[[stage]]\n{stage}\n" for stage in stages))

    def stages(self, output="out"):
        return json.loads((self.place / output / "run.json").read_text())["stages"]

    def assert_same(self, one, other, without=()):
        """Records and tracks are alike, digit by digit."""
        for file in ("record.csv", "tracks.csv"):
            for left, right in zip(self.rows(one, file), self.rows(other, file), strict=True):
                self.assertEqual({k: v for k, v in left.items() if k not in without},
                                 {k: v for k, v in right.items() if k not in without})  # fmt: skip

    def test_friction_comes_and_goes(self):
        """A ball that slides at 1 m/s rolls at 2/3 m/s (disk) or 5/7 m/s (sphere) once there is friction: from then on its kinetic
        energy is this share of that at the start."""
        law = "[[stage.law]]\nfriction = 0.3\n"
        for body, gravity, share, mass in ((DISK, (0.0, -10.0), 2 / 3, 10 * pi), (SPHERE, (0.0, 0.0, -10.0), 5 / 7, 4 / 3 * pi)):
            with self.subTest(dimension=len(gravity)):
                self.write(body, ['name = "smooth"\nsteps = 100', f'name = "rough"\nduration = 0.3\n{law}', "steps = 100"],
                           gravity=gravity)
                said = self.call().stdout
                rows = self.rows()
                self.assertEqual([row["stage"] for row in rows], ["1"] * 100 + ["2"] * 300 + ["3"] * 100)
                self.assertEqual([row["stage"] for row in self.rows(file="tracks.csv")][::2], [row["stage"] for row in rows])
                for step, expected in ((100, 1.0), (400, share), (500, share)):
                    self.assertAlmostEqual(float(rows[step - 1]["kinetic_energy"]) / (mass / 2), expected, delta=ROUNDING)
                self.assertLess(max(float(row["energy_closure"]) for row in rows), ROUNDING)
                for words in ('stage      1 "smooth" of 3: steps 1 to 100', 'stage      2 "rough" of 3: steps 101 to 400',
                              "stage      3 of 3: steps 401 to 500", "done: 500 of 500 steps", "converged     500 of 500 steps",
                              '2 "rough": 300 steps to 4.000E-01 s'):  # fmt: skip
                    self.assertIn(words, said)
        expected = [(1, "smooth", 1, 100), (2, "rough", 101, 400), (3, "", 401, 500)]
        self.assertEqual([(s["stage"], s["name"], s["first_step"], s["last_step"]) for s in self.stages()], expected)
        self.assertEqual({(s["reason"], s["unconverged_steps"]) for s in self.stages()}, {("all steps done", 0)})
        self.assertAlmostEqual(self.stages()[1]["end_time"], 0.4, delta=ROUNDING)

    def test_drives_gravity_and_time_step(self):
        """A plate is held, lifted at 0.5 m/s, thrown, held again by times of its stage, with another step, and falls under a third of
        gravity: closed forms."""
        held = drive("x") + drive("y") + drive("rotation")
        self.write(PLATE, ["steps = 100\n" + held,
                           "steps = 200\n" + drive("x") + drive("y", "0.5 + 0*t", "start = 0.0\n") + drive("rotation"),
                           "steps = 100",
                           "steps = 400\n[stage.time]\nstep = 5e-4\n" + drive("y", "-0.5*(t < 0.0501)", "end = 0.1\n"),
                           "duration = 0.1\n[stage.scene]\ngravity = [0.0, -5.0]\n"])  # fmt: skip
        self.call()
        height = {int(row["step"]): float(row["y"]) for row in self.rows(file="tracks.csv")}
        speed = {int(row["step"]): float(row["velocity_y"]) for row in self.rows(file="tracks.csv")}
        # A step in which a drive begins or ends moves by the mean of both velocities.
        jump = 0.5 * 1e-3
        for step, place, velocity in ((100, 1.0, 0.0), (300, 1.1, 0.5), (400, 1.1, -0.5),
                                      (500, 1.1 - 0.025, -0.5), (501, 1.1 - 0.025, 0.0), (600, 1.1 - 0.025, 0.0), (800, 1.1 - 0.025 - 0.05, -1.0),
                                      (900, 1.1 - 0.025 - 0.05 - 0.1 - 0.025, -1.5)):  # fmt: skip
            self.assertAlmostEqual(speed[step], velocity, delta=ROUNDING, msg=step)
            self.assertAlmostEqual(height[step], place, delta=3 * jump, msg=step)
        self.assertAlmostEqual(float(self.rows()[-1]["time"]), 0.7, delta=ROUNDING)
        self.assertLess(max(float(row["energy_closure"]) for row in self.rows()), ROUNDING)

    def test_conditions(self):
        """A plate falls until its velocity is beyond a limit, then until it has moved on, then for a time: steps by g t."""
        self.write(PLATE, ['steps = 500\nuntil = "max_velocity > 1.0005"',
                           'until = ["time < 0", "velocity_y(plate) < -2.0005"]\nfor = 3',
                           'duration = 0.5\nuntil = "time > 0"\nafter = 0.0345'], time="steps = 1000")  # fmt: skip
        said = self.call().stdout
        ends = [101, 203, 238]
        self.assertEqual([stage["last_step"] for stage in self.stages()], ends)
        self.assertEqual(ceil(1.0005 / 10 * 1000), ends[0])
        self.assertTrue(self.stages()[1]["reason"].startswith('end condition "velocity_y(plate) < -2.0005" at 2.030E-01 s: '))
        self.assertIn("time       3 stages, at most 1000 steps; results in", said)
        self.assertIn('stage      1 ended after 101 steps, time 1.010E-01 s (end condition "max_velocity > 1.0005"', said)
        run = json.loads((self.place / "out/run.json").read_text())
        self.assertEqual([run["status"], run["stop_condition"], run["steps"]], ["done", "time > 0", 238])

    def test_same_as_runs_by_restart(self):
        """Two stages are, digit by digit, two runs of which the second goes on from the checkpoint of the first; also with another
        time step, in parts of one process, and on several ranks."""
        stages = ["steps = 60", f"steps = 80\n[stage.time]\nstep = 5e-4\n[[stage.law]]\nfriction = 0.4\n{SHEAR}"]
        self.write(PACK, stages)
        self.write(PACK, [], "first", time="steps = 60")
        self.write(PACK + SHEAR.replace("stage.", "").replace("min(1, t/0.01)", "max(0, min(1, (t - 0.06)/0.01))"), [], "second", friction=0.4,
                   time="steps = 140")  # fmt: skip
        second = self.place / "second.toml"
        second.write_text(second.read_text().replace("step = 1e-3", "step = 5e-4"))
        few = ("--set", "solver.tolerance=1e-2")
        for words, ranks in (((), 1), ((*few, "--set", "partition.parts=3"), 1), (few, 2)):
            with self.subTest(words=words, ranks=ranks):
                self.call(*words, ranks=ranks if self.launcher else 1)
                self.call(*words, deck="first", output="two", ranks=ranks if self.launcher else 1)
                self.call("--restart", "two", *words, deck="second", output="two", ranks=ranks if self.launcher else 1)
                self.assert_same("out", "two", without=("stage",))

    def test_restart_within_a_stage(self):
        """A run that ends within a stage, at its end or after all of them goes on as the one that never ended."""
        self.write(PACK, ["steps = 40", f'steps = 50\nuntil = "time > 0.0695"\n[stage.time]\nstep = 7e-4\n{SHEAR}',
                          f"steps = 30\n{SHEAR}[[stage.law]]\nfriction = 0.4"])  # fmt: skip
        self.call()
        ends = [stage["last_step"] for stage in self.stages()]
        self.assertEqual(ends, [40, 40 + ceil((0.0695 - 0.04) / 7e-4), 40 + ceil((0.0695 - 0.04) / 7e-4) + 30])
        for step in (25, 40, 63, ends[1], ends[2] - 5):
            with self.subTest(step=step):
                self.call("--set", f"time.steps={step}", output="parts")
                said = self.call("--restart", "parts", output="parts").stdout
                self.assertIn(f"done: {ends[2]} of", said)
                self.assert_same("out", "parts")
                self.assertEqual(self.stages("parts"), self.stages())
        before = (self.place / "parts/record.csv").read_bytes()
        self.assertIn(f"nothing to do: step {ends[2]} of {ends[2]}", self.call("--restart", "parts", output="parts").stdout)
        self.assertEqual((self.place / "parts/record.csv").read_bytes(), before)
        self.write(PACK, ["steps = 40", f'steps = 50\nuntil = "time > 0.0695"\n[stage.time]\nstep = 7e-4\n{SHEAR}',
                          f"steps = 30\n{SHEAR}[[stage.law]]\nfriction = 0.4", "steps = 7"])  # fmt: skip
        self.assertIn(f"done: {ends[2] + 7} of {ends[2] + 7} steps", self.call("--restart", "parts", output="parts").stdout)

    def test_stages_of_a_prepared_sample(self):
        """Stages may begin from a checkpoint of a deck without them, which is the first stage's beginning."""
        self.write(DISK, [], "sample", time="steps = 30")
        self.call(deck="sample", output="sample")
        self.write(DISK, ["steps = 20", "steps = 20\n[[stage.law]]\nfriction = 0.3"])
        self.call("--restart", "sample")
        self.assertEqual([(s["first_step"], s["last_step"]) for s in self.stages()], [(31, 50), (51, 70)])
        self.assertEqual([row["step"] for row in self.rows()], [str(step) for step in range(31, 71)])

    def test_pictures_of_one_stage(self):
        """Pictures are those of the stages that ask for them, in one file; the log tells what is written where it changes."""
        self.write(DISK, ["steps = 20", "steps = 20\n[stage.output]\nevery = 5", "steps = 10", "steps = 10"])
        outputs = [line for line in self.call().stdout.splitlines() if line.startswith("outputs")]
        self.assertEqual([re.search("(no )?pictures[^,]*", line)[0] for line in outputs],
                         ["no pictures", "pictures every 5 steps", "no pictures"])
        try:
            import h5py
        except ImportError:
            self.skipTest("no h5py")
        with h5py.File(self.place / "out/bodies.vtkhdf") as file:
            times = file["VTKHDF/Steps/Values"][:]
        self.assertEqual([round(time * 1e3) for time in times], [25, 30, 35, 40])

    def test_effective_deck_is_the_deck(self):
        self.write(PACK, ['name = "a"\nsteps = 10', f'name = "b"\nsteps = 10\n[[stage.law]]\nfriction = 0.4\n{SHEAR}'
                          '[stage.solver]\ntolerance = 1e-10'])  # fmt: skip
        self.call()
        (self.place / "again.toml").write_text((self.place / "out/effective.toml").read_text())
        self.call(deck="again", output="again")
        self.assert_same("out", "again")
        self.assertEqual((self.place / "out/effective.toml").read_text(), (self.place / "again/effective.toml").read_text())
        said = self.call("--restart", "out", "--set", "stage[2].steps=12").stderr
        self.assertIn("stage[2].steps = 12 (was 10)", said)
        self.assertEqual(len(self.rows()), 22)

    def test_settings_of_a_stage(self):
        """A setting changes a key of a stage, or adds it; others stay."""
        self.write(PLATE, ["steps = 30", "steps = 20\n" + drive("y", 0.2)])
        self.call("--set", "stage[2].drive[1].value=0.4", "--set", "stage[1].scene.gravity=[0, -20]", "--set", "stage[1].time.step=2e-3")
        last = self.rows(file="tracks.csv")[-1]
        self.assertAlmostEqual(float(last["velocity_y"]), 0.4, delta=ROUNDING)
        self.assertAlmostEqual(float(last["time"]), 0.08, delta=ROUNDING)
        self.assertAlmostEqual(float(self.rows(file="tracks.csv")[29]["velocity_y"]), -20 * 0.06, delta=ROUNDING)
        self.assertIn("[stage.scene]\ngravity = [0.0, -20.0]\n", (self.place / "out/effective.toml").read_text())
        for setting, words in (("stage[3].time.step=1", "the deck has 2 stages"), ("stage[1].drive.value=1", "stage 1 has no [[drive]] number 1"),
                               ("stage[1].time.steps=3", '"time.steps" cannot change between stages'),
                               ("stage[2].solver.tolerence=1", 'unknown key "tolerence" in [solver]'),
                               ("stage[1].solver.tolerance=-1", '"stage[1].solver.tolerance" must be larger than 0')):  # fmt: skip
            self.assertIn(words, self.call("--set", setting, code=2).stderr)

    def test_bad_input(self):
        """One sentence each, at its place."""
        for stages, words, place in (
            (["steps = 10\nduration = 1.0"], 'a stage has either "steps" or "duration"', "duration"),
            (["name = 'x'"], 'a stage needs "steps" or "duration"', "[[stage]]"),
            (["steps = 10\nuntil = 'max_velocty < 1'"], 'there is no "max_velocty" here; did you mean "max_velocity"?', "until"),
            (["steps = 10", "steps = 10\nuntil = 'max_velocity'"], "this is no condition", "until = 'max"),
            (["steps = 10\nname = 'a'", "steps = 10\nname = 'a'"], 'two stages have the name "a"', "name = 'a'"),
            (["steps = 10\n[stage.solvr]\ntolerance = 1.0"], 'unknown key "solvr" in [[stage]]; did you mean "solver"?', "[stage.solvr]"),
            (["steps = 10\n[stage.time]\nsteps = 3"], '"steps" cannot change between stages', "steps = 3"),
            (["steps = 10\n[stage.scene]\nperiod_x = 3.0"], '"period_x" cannot change between stages', "period_x"),
            (["steps = 10\n[[stage.body]]\nname = 'x'"], '"body" cannot change between stages', "[[stage.body]]"),
            (["steps = 10\n[[stage.solver]]\ntolerance = 1.0"], "[stage.solver] needs single brackets", "[[stage.solver]]"),
            (["steps = 10\n[stage.drive]\nbody = 'ball'"], "[[stage.drive]] needs double brackets", "[stage.drive]"),
            (["steps = 10\n[stage.solver]\ntolerance = -1.0"], '"tolerance" must be', "tolerance = -1.0"),
            (["steps = 10", "steps = 9\n[stage.solver]\ntolerence = 1e-3"], 'unknown key "tolerence"', "tolerence"),
            (["steps = 10", "steps = 9\n[[stage.law]]\nname = 'rubing'"], 'there is no law named "rubing"', "name = 'rubing'"),
            (["steps = 10", "steps = 9\n[[stage.drive]]\nbody = 'bell'\ncomponent = 'x'"], 'there is no body named "bell"', "body = 'bell'"),
            (["steps = 10", "steps = 9\n[[stage.drive]]\nbody = 'ball'\ncomponent = 'x'\nvalue = '1/t'"], "has no value at t = 0.0 s", "value"),
            (["steps = 10", "steps = 9\n[[stage.drive]]\nbody = 'ball'"], 'lacks the key "component"', "[[stage.drive]]"),
        ):  # fmt: skip
            with self.subTest(words=words):
                self.write(DISK, stages)
                text = (self.place / "deck.toml").read_text().splitlines()
                line = max(i for i, text_line in enumerate(text, 1) if text_line.startswith(place))
                for command in (("run", "deck.toml"), ("check", "deck.toml"), ("run", "deck.toml", "--set", "partition.parts=2")):
                    said = self.run_program(*command, code=2).stderr
                    self.assertIn(words, said)
                    self.assertNotIn("ranks report this", said)
                    self.assertRegex(said, rf"deck.toml:{line}:\d+: error: ")
                    self.assertRegex(said, r"\n +\^")
        self.write(DISK + "[stop]\nwhen = 'time > 1'\n", ["steps = 10"])
        self.assertIn("end conditions of a deck with stages stand in the stages", self.run_program("run", "deck.toml", code=2).stderr)
        self.write(DISK + "[report]\ntrace = true\ntrace_steps = [5]\n", ["steps = 10"])
        self.assertIn("traces do not go over several stages", self.run_program("run", "deck.toml", code=2).stderr)
        self.assertFalse((self.place / "deck.results").exists())

    def test_failures_leave_the_stages_in_run_json(self):
        """A stage that does not converge ends the run as any other, and leaves no lock."""
        self.write(PACK, ["steps = 20", f"steps = 40\n{SHEAR}[stage.solver]\nmaximum_sweeps = 1\nstop_unconverged = true"])
        self.call(code=3)
        run = json.loads((self.place / "out/run.json").read_text())
        self.assertEqual(run["status"], "not converged")
        self.assertIn(run["steps"], range(21, 60))
        self.assertEqual([s["reason"] for s in run["stages"]], ["all steps done", "not at its end"])
        self.assertFalse((self.place / "out/run.lock").exists())

    def test_shipped_decks(self):
        """Each comes through all its stages, shortened."""
        for name, count in (("consolidate_then_shear", 2), ("settle_then_release", 3), ("pour_then_tamp", 4)):
            with self.subTest(deck=name):
                short = [word for i in range(count) for word in ("--set", f"stage[{i + 1}].duration=0.02")]
                self.run_program("run", DECKS / f"{name}.toml", "--output", name, *short)
                self.assertEqual(len(self.stages(name)), count)
                self.assertEqual({row["stage"] for row in self.rows(name)}, {str(i + 1) for i in range(count)})


if __name__ == "__main__":
    take_program()
    unittest.main()
