#!/usr/bin/env python3
"""End conditions from outside: the step at which a fall or a slide ends by its closed form, what run.json and the verdict report,
records in a row, restarts, several ranks, and conditions that are wrong."""

import csv
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

G = 9.81
START = """[time]
step = 1e-3
steps = 500
[solver]
criterion = "e8"
tolerance = 1e-12
[output]
record_every = 1
[stop]
{stop}
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.2
"""
BALL = """[[body]]
name = "ball"
shape = "disk"
radius = 0.1
position = [0.0, 50.0]
"""
SOLID = BALL.replace("disk", "sphere").replace("[0.0, 50.0]", "[0.0, 0.0, 50.0]")
BLOCK = """[[body]]
name = "block"
shape = "polygon"
vertices = [[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]
position = [0.0, 0.05]
velocity = [0.5, 0.0]
[[wall]]
name = "floor"
from = [-1.0, -0.05]
to = [2.0, -0.05]
thickness = 0.1
"""
TRACK = '[[track]]\nbody = "*"\n'


class Stops(ProgramCase):
    def run_deck(self, stop, scene, *words, output="out", code=0, head=""):
        (self.place / "deck.toml").write_text(head + START.format(stop=stop) + scene)
        return self.run_program("run", "deck.toml", "--output", output, "--force", *words, code=code)

    def run_json(self, output="out"):
        return json.loads((self.place / output / "run.json").read_text())

    def steps(self, output="out"):
        with (self.place / output / "record.csv").open() as file:
            return [int(row["step"]) for row in csv.DictReader(file)]

    def test_fall(self):
        """A ball that falls ends its run in the first recorded step in which g t^2/2, or g t, is beyond the limit; in space too."""
        for scene, head in ((BALL, ""), (SOLID, "[scene]\ndimension = 3\n")):
            for condition, step in (("displacement(ball) > 0.1", int((0.2 / G) ** 0.5 * 1e3) + 1), ("max_velocity >= 1", int(1e3 / G) + 1),
                                    ("time > 0.0995 and not step > 1000", 100), ("mean_velocity/9.81 > 0.2505", 251)):
                with self.subTest(condition=condition, head=head):
                    said = self.run_deck(f'when = "{condition}"', scene + TRACK, head=head).stdout
                    run = self.run_json()
                    self.assertEqual([run["status"], run["steps"], self.steps()[-1]], ["done", step, step])
                    self.assertEqual(run["stop_condition"], condition)
                    self.assertAlmostEqual(run["stop_time"], step * 1e-3, places=12)
                    self.assertIn(f"done: {step} of 500 steps", said)
                    self.assertIn(f'end condition "{condition}" at', said)
                    if condition.startswith("displacement"):
                        self.assertAlmostEqual(run["stop_value"], G * (step * 1e-3) ** 2 / 2, places=9)
                        self.assertIn("displacement(ball) is 1.", run["reason"])

    def test_slide(self):
        """Friction stops a block after v / (mu g): the run ends when its velocity has been nothing for five recorded steps in a row, at
        steps that are recorded alone."""
        at_rest = -(-0.5 / (0.2 * G) // 1e-3)
        for every, records in ((1, 1), (1, 5), (10, 3)):
            with self.subTest(every=every, records=records):
                self.run_deck(f'when = ["max_velocity > 1", "velocity_x(block) < 1e-9"]\nfor = {records}', BLOCK + TRACK,
                              "--set", f"output.record_every={every}")
                first = -(-at_rest // every) * every
                self.assertEqual(self.run_json()["steps"], first + (records - 1) * every)
                self.assertEqual(self.steps()[-1], self.run_json()["steps"])

    def test_after(self):
        """Before a time nothing is tested, and what never holds ends nothing."""
        self.run_deck('when = "time > 0"\nafter = 0.123', BALL)
        self.assertEqual(self.run_json()["steps"], 123)
        self.run_deck('when = ["max_velocity < 0", "1/(time - time) > 0"]', BALL)
        self.assertEqual(self.run_json()["steps"], 500)
        self.assertNotIn("stop_condition", self.run_json())
        self.assertEqual(self.run_json()["reason"], "")

    def test_outputs_at_the_end(self):
        """The last step is drawn and saved like any other last one, and a run goes on from there."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5")
        self.run_deck('when = "time > 0.0995"', BALL, "--set", "output.every=1000", "--set", "output.record_every=30")
        self.assertEqual(self.steps(), [30, 60, 90, 120])
        self.assertIn("restart_a.h5", self.run_json()["file_restart"])
        self.run_deck('when = "time > 0.2"', BALL, "--restart", "out", "--set", "output.record_every=30")
        self.assertEqual(self.run_json()["steps"], 210)

    def test_restart(self):
        """Counts of steps in a row go on: a run in parts ends where the straight one does."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        stop = 'when = ["displacement(ball) > 0.05", "max_velocity > 0.5"]\nfor = 30'
        self.run_deck(stop, BALL + TRACK, "--set", "restart.every=70")
        straight = self.run_json()
        self.assertEqual(straight["steps"], int(0.5e3 / G) + 1 + 29)
        (self.place / "deck.toml").write_text(START.format(stop=stop) + BALL + TRACK)
        self.run_program("run", "deck.toml", "--output", "out", "--restart", "out/restart_a.h5")
        same = ("steps", "reason", "stop_condition", "stop_time", "stop_value", "kinetic_energy")
        for key in same:
            self.assertEqual(self.run_json()[key], straight[key])
        # The run has ended: nothing is left to do, except for files that a killed run has not closed.
        done = self.run_program("run", "deck.toml", "--output", "out", "--restart", "out")
        self.assertIn(f"nothing to do: step {straight['steps']} of 500 (out), {straight['reason']}", done.stdout)
        (self.place / "out" / "run.json").unlink()
        self.run_program("run", "deck.toml", "--output", "out", "--restart", "out")
        for key in same:
            self.assertEqual(self.run_json()[key], straight[key])

    def test_ranks(self):
        """Ranks end together, at the step at which one alone ends; so do subdomains of one rank."""
        scene = BLOCK + BALL.replace("[0.0, 50.0]", "[1.0, 0.3]") + TRACK
        stop = 'when = "velocity_x(block) < 0.1"'
        self.run_deck(stop, scene)
        wanted = [self.run_json()[key] for key in ("steps", "stop_condition", "stop_time")]
        self.run_deck(stop, scene, "--set", "partition.parts=2", output="parts")
        self.assertEqual([self.run_json("parts")[key] for key in ("steps", "stop_condition", "stop_time")], wanted)
        if not self.launcher:
            return
        self.call(output="ranks", ranks=2)
        self.assertEqual([self.run_json("ranks")[key] for key in ("steps", "stop_condition", "stop_time")], wanted)

    def test_mistakes(self):
        """What is no condition: sentence, line, column, caret, suggestion; also by `check`."""
        for condition, column, sentence in (
                ("max_velocty < 1", 9, 'there is no "max_velocty" here; did you mean "max_velocity"?'),
                ("time > 1 and strain_qq > 1", 22, 'there is no "strain_qq" here'),
                ("displacement(bal) > 1", 9, 'did you mean "displacement(ball)"?'),
                ("max_velocity", 9, "this is no condition"), ("time + 1", 9, "this is no condition"),
                ("time >", 14, "ends where a number"), ("time > 1)", 17, "an operation should stand here"),
                ("", 8, "must not be empty")):
            with self.subTest(condition=condition):
                said = self.run_deck(f'when = "{condition}"', BALL + TRACK, code=2).stderr
                self.assertIn(sentence, said)
                self.assertRegex(said, rf"deck\.toml:10:{column}: error: ")
                self.assertIn("\n  " + " " * (column - 1) + "^", said)
                self.assertEqual(self.run_program("check", "deck.toml", code=2).stderr, said)
        said = self.run_deck('when = ["time > 1",\n  "tim > 1"]', BALL, code=2).stderr
        self.assertRegex(said, r'deck\.toml:11:4: error: there is no "tim" here; did you mean "time"')
        said = self.run_deck('when = "force_x(ball) > 1"', BALL, code=2).stderr
        self.assertIn('there is no "force_x(ball)" here; a body is named here where [[track]] follows it', said)
        said = self.run_deck("", BALL, "--set", "stop.when=tim > 1", code=2).stderr
        self.assertIn('--set: error: there is no "tim" here', said)
        said = self.run_deck('when = "time > 1"', BALL, "--set", "output.record_every=0", code=2).stderr
        self.assertIn("output.record_every is 0", said)

    def test_setting(self):
        """A condition on the command line."""
        self.run_deck("", BALL, "--set", "stop.when=time > 0.0105")
        self.assertEqual(self.run_json()["steps"], 11)


if __name__ == "__main__":
    take_program()
    unittest.main()
