#!/usr/bin/env python3
"""Tracked bodies from outside: closed forms of place, force, torque and work, the sums of all bodies against the record, restarts to
the byte, several ranks, and names that no body has."""

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
steps = {steps}
[solver]
criterion = "e8"
tolerance = 1e-12
[output]
record_every = {every}
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = {friction}
"""
SPACE = "[scene]\ndimension = 3\n"
FLOOR = """[[wall]]
name = "floor"
from = [-3.0, -0.05]
to = [3.0, -0.05]
thickness = 0.1
"""
PLANE = """[[wall]]
name = "floor"
centre = [0.0, 0.0, 0.0]
normal = [0.0, 0.0, 1.0]
size = [6.0, 6.0]
thickness = 0.1
"""
BLOCK = """[[body]]
name = "block"
shape = "polygon"
vertices = [[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]
position = [0.0, 0.05]
"""
BALL = """[[body]]
name = "ball"
shape = "sphere"
radius = 0.05
position = [0.3, 0.1, 0.25]
"""
WEIGHT = 0.2 * 0.1 * 2500.0 * G
# Of the solver (1e-12 of the largest impulse) over a sum of a few contacts, and as much again for each step of a work.
EXACT = 1e-9
EVERYTHING = '[[track]]\nbody = "*"\n'


def disk(name, x, y, more="", radius=0.05):
    """A disk as a block of a deck."""
    return f'[[body]]\nname = "{name}"\nshape = "disk"\nradius = {radius}\nposition = [{x}, {y}]\n{more}'


def start(steps=100, every=10, friction=0.3):
    return START.format(steps=steps, every=every, friction=friction)


class Tracks(ProgramCase):
    def rows(self, body=None, output="out"):
        """Rows of a body, or of all, with numbers for words."""
        with (self.place / output / "tracks.csv").open(newline="") as file:
            rows = [{name: value if name == "body" else float(value) for name, value in row.items()} for row in csv.DictReader(file)]
        return [row for row in rows if body in (None, row["body"])]

    def run_json(self, output="out"):
        return json.loads((self.place / output / "run.json").read_text())

    def near(self, got, wanted, scale=WEIGHT):
        self.assertLessEqual(abs(got - wanted), EXACT * scale, f"{got} is not {wanted}")

    def test_rest(self):
        """A block at rest: its weight on the floor, and back; no torque, no work."""
        self.run_deck(start() + FLOOR + BLOCK + EVERYTHING)
        self.assertEqual(len(self.rows()), 20)
        self.assertEqual(self.run_json()["file_tracks"], "tracks.csv")
        for row in self.rows("floor"):
            for name, wanted in {"force_x": 0, "force_y": -WEIGHT, "mean_force_y": -WEIGHT, "torque": 0, "contact_work": 0,
                                 "drive_work": 0, "displacement": 0, "contacts": 2}.items():
                self.near(row[name], wanted)
        for row in self.rows("block"):
            self.near(row["force_y"], WEIGHT)
            self.near(row["mean_force_y"], WEIGHT)
            self.near(row["y"], 0.05, 1)
            self.near(row["torque"], 0)

    def test_fall(self):
        """A ball falls: y0 - g t^2/2, which the mid-point rule has exactly; nothing touches it."""
        self.run_deck(SPACE + start() + BALL.replace("0.25", "50.0") + PLANE + EVERYTHING)
        for row in self.rows("ball"):
            t = row["time"]
            self.near(row["z"], 50 - G * t**2 / 2, 50)
            self.near(row["velocity_z"], -G * t, 1)
            self.near(row["displacement"], G * t**2 / 2, 50)
            self.assertEqual([row["force_z"], row["contact_work"], row["contacts"], row["orientation_w"]], [0, 0, 0, 1])

    def test_pushed_block(self):
        """A plate at 0.1 m/s pushes a block over the floor: the force is friction times weight, works are the force times the way."""
        plate = '[[wall]]\nname = "plate"\nfrom = [-0.11, 0.02]\nto = [-0.11, 0.08]\nthickness = 0.02\nvelocity = [0.1, 0.0]\n'
        # Plate and block meet without friction, so that the block is not lifted.
        laws = '[[law]]\nname = "smooth"\nfriction = 0.0\n[[interaction]]\ncandidate = "grain"\nantagonist = "plate"\nlaw = "smooth"\n' \
               '[[interaction]]\ncandidate = "grain"\nantagonist = "wall"\nlaw = "contact"\n'
        self.run_deck(start(400, 100, 0.4) + laws + FLOOR + BLOCK + plate + 'colour = "plate"\n' + EVERYTHING)
        force = 0.4 * WEIGHT
        for before, row in zip(self.rows("plate"), self.rows("plate")[1:]):
            way = row["x"] - before["x"]
            self.near(way, 0.01, 1)
            self.near(row["force_x"], -force)
            self.near(row["mean_force_x"], -force)
            self.near(row["contact_work"] - before["contact_work"], -force * way)
            self.near(row["drive_work"] - before["drive_work"], force * way)
        for before, row in zip(self.rows("block"), self.rows("block")[1:]):
            # What the plate brings the floor takes: the block gains nothing.
            self.near(row["force_x"], 0)
            self.near(row["contact_work"] - before["contact_work"], 0)
            self.near(row["velocity_x"], 0.1, 1)

    def test_beam(self):
        """A beam of 1 m on supports 0.3 m and 0.1 m from its middle: they share its weight as 1 to 3, and it does not turn."""
        beam = BLOCK.replace("0.1, -0.05", "0.5, -0.05").replace("0.1, 0.05", "0.5, 0.05").replace('"block"', '"beam"')
        supports = disk("left", -0.3, -0.05, "fixed = true\n") + disk("right", 0.1, -0.05, "fixed = true\n")
        self.run_deck(start(friction=0.0) + beam + supports + '[[track]]\nbody = "beam"\n[[track]]\nbody = "*t"\n[[track]]\nbody = "lef?"\n')
        self.assertEqual([row["body"] for row in self.rows()][:3], ["beam", "left", "right"])
        for left, right, beam in zip(self.rows("left"), self.rows("right"), self.rows("beam")):
            self.near(left["force_y"], -5 * WEIGHT / 4, 5 * WEIGHT)
            self.near(right["force_y"], -15 * WEIGHT / 4, 5 * WEIGHT)
            self.near(beam["torque"], 0, 5 * WEIGHT)

    def test_paddle(self):
        """A ball on a plate that is held: a torque of weight times arm; a plate that turns gives on the work that
        drives it, its own spin apart."""
        weight = 2500 * 3.141592653589793 * 0.05**2 * G
        for spin in (0.0, 0.05):
            plate = '[[body]]\nname = "plate"\nshape = "polygon"\nvertices = [[-1.0, -0.1], [1.0, -0.1], [1.0, 0.0], [-1.0, 0.0]]\n' \
                    "fixed = true\n"
            drive = f'[[drive]]\nbody = "plate"\ncomponent = "rotation"\nvalue = {spin}\n'
            self.run_deck(start(friction=0.0) + plate + disk("ball", 0.4, 0.05) + drive + EVERYTHING, "--force")
            row = self.rows("plate")[-1]
            if spin == 0:
                self.near(row["force_y"], -weight, weight)
                self.near(row["torque"], -0.4 * weight, weight)
                self.near(row["mean_torque"], -0.4 * weight, weight)
            self.near(row["drive_work"] + row["contact_work"], 500 * (2**2 + 0.1**2) / 12 * spin**2 / 2, weight)
            self.assertEqual(row["contact_work"] < 0, spin > 0)

    def test_ball_in_space(self):
        """A ball at rest on a plane in space, 0.3 m and 0.1 m from its middle: force and torque on the plane."""
        weight = 2500 * 4 / 3 * 3.141592653589793 * 0.05**3 * G
        self.run_deck(SPACE + start() + BALL.replace("0.25", "0.05") + PLANE + '[[track]]\nbody = 2\n')
        for row in self.rows("floor"):
            for name, wanted in {"force_x": 0, "force_y": 0, "force_z": -weight, "torque_x": -0.1 * weight,
                                 "torque_y": 0.3 * weight, "torque_z": 0, "mean_torque_y": 0.3 * weight}.items():
                self.near(row[name], wanted, weight)

    def moving_scene(self, is_in_space, steps=200):
        """Grains fall into a shaken box, all bodies tracked by number."""
        shake = "amplitude = 0.3\nfrequency = 20.0\n"
        if is_in_space:
            box = '[[container]]\nsize = [0.3, 0.3, 0.5]\n'
            drive = f'[[drive]]\nbody = "box.floor"\ncomponent = "z"\n{shake}[[drive]]\nbody = "box.left"\ncomponent = "rotation_x"\n{shake}'
            grains = '[[sample]]\nshape = "sphere"\nbox = [0.0, 0.0, 0.01, 0.3, 0.3, 0.3]\ncount = 40\nradius = [0.02, 0.03]\n'
            bodies = 45
        else:
            box = FLOOR + '[[wall]]\nname = "left"\nfrom = [-0.01, -0.1]\nto = [-0.01, 1.0]\nthickness = 0.02\n' \
                '[[wall]]\nname = "right"\nfrom = [0.41, -0.1]\nto = [0.41, 1.0]\nthickness = 0.02\n'
            drive = f'[[drive]]\nbody = "floor"\ncomponent = "y"\n{shake}[[drive]]\nbody = "left"\ncomponent = "rotation"\n{shake}'
            grains = '[[sample]]\nkind = "random"\nbox = [0.0, 0.0, 0.4, 0.5]\ncount = 40\nradius = [0.02, 0.03]\n'
            bodies = 43
        tracks = "".join(f"[[track]]\nbody = {i + 1}\n" for i in range(bodies))
        text = start(steps, 7).replace("1e-12", "1e-6") + box + drive + grains + tracks
        return (SPACE if is_in_space else "") + text

    def check_sums(self, output, is_in_space):
        """Works of all bodies add up to those of the record; forces inside add up to nothing."""
        with (self.place / output / "record.csv").open() as file:
            records = list(csv.DictReader(file))
        by_step = {}
        for row in self.rows(output=output):
            by_step.setdefault(int(row["step"]), []).append(row)
        self.assertEqual([int(record["step"]) for record in records], list(by_step))
        for record in records:
            rows = by_step[int(record["step"])]
            works = {name: sum(row[name] for row in rows) for name in ("contact_work", "drive_work")}
            scale = sum(abs(row["contact_work"]) + abs(row["drive_work"]) for row in rows) + 1e-12
            losses = float(record["friction_loss"]) + float(record["impact_loss"])
            # Rounding of sums over 200 steps.
            self.assertLessEqual(abs(works["contact_work"] + losses), 1e-11 * scale)
            self.assertLessEqual(abs(works["drive_work"] - float(record["drive_work"])), 1e-11 * scale)
            for axis in "xyz"[:3 if is_in_space else 2]:
                forces = [row["force_" + axis] for row in rows]
                self.assertLessEqual(abs(sum(forces)), 1e-11 * sum(map(abs, forces)) + 1e-12)

    def test_sums(self):
        """All bodies of a shaken box, in the plane and in space, on one rank and as three subdomains."""
        for is_in_space in (False, True):
            for parts in (1, 3):
                with self.subTest(is_in_space=is_in_space, parts=parts):
                    self.run_deck(self.moving_scene(is_in_space), "--force", "--set", f"partition.parts={parts}")
                    self.check_sums("out", is_in_space)

    def test_restart(self):
        """A run that goes on from a checkpoint between two rows writes the very same file."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        for is_in_space in (False, True):
            with self.subTest(is_in_space=is_in_space):
                words = ("--set", "restart.every=80", "--set", "restart.at_end=false")
                self.run_deck(self.moving_scene(is_in_space), "--force", *words)
                straight = (self.place / "out" / "tracks.csv").read_bytes()
                self.run_deck(self.moving_scene(is_in_space), *words, "--restart", "out/restart_a.h5")
                self.assertEqual((self.place / "out" / "tracks.csv").read_bytes(), straight)
                # In another folder the rows after the checkpoint stand alone, the same.
                other = f"other{is_in_space}"
                self.run_deck(self.moving_scene(is_in_space), *words, "--restart", "out/restart_b.h5", output=other)
                lines = (self.place / other / "tracks.csv").read_bytes().splitlines()
                self.assertEqual(lines[1:], straight.splitlines()[-len(lines) + 1:])

    def test_restart_with_other_tracks(self):
        """A body that is tracked from a checkpoint on begins there; others go on."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        text = SPACE + start(100, 50) + BALL.replace("0.25", "50.0") + BALL.replace("0.25", "70.0").replace("ball", "other") + PLANE
        self.run_deck(text + '[[track]]\nbody = "ball"\n', "--set", "time.steps=50")
        self.run_deck(text + EVERYTHING, "--restart", "out")
        t = self.rows("ball")[-1]["time"]
        self.near(self.rows("ball")[-1]["displacement"], G * t**2 / 2, 50)
        self.near(self.rows("other")[-1]["displacement"], G * (t**2 - 0.05**2) / 2, 50)

    def test_ranks(self):
        """Several ranks: the same bytes where the subdomains are the same, the same numbers where they are not."""
        launcher = self.launcher
        if not launcher:
            self.skipTest("no MPI")
        text = start(100, 10, 0.0) + FLOOR + "".join(disk(f"g{i}{j}", 0.2 * i - 1, 0.05 + 0.1 * j) for i in range(10) for j in range(3))
        text += EVERYTHING
        self.run_deck(text)
        alone = self.rows()
        for ranks in (2, 3):
            self.on_ranks(ranks, text, "ranks")
            for a, b in zip(alone, self.rows(output="ranks"), strict=True):
                self.assertEqual([a["step"], a["body"], a["contacts"]], [b["step"], b["body"], b["contacts"]])
                for name in a:
                    if name != "body":
                        self.near(a[name], b[name])
        texts = []
        for ranks in (1, 3):
            self.on_ranks(ranks, self.moving_scene(False), f"parts{ranks}", "--set", "partition.parts=3")
            texts.append((self.place / f"parts{ranks}" / "tracks.csv").read_bytes())
        self.assertEqual(*texts)
        self.check_sums("parts3", False)

    def test_names(self):
        """A name with a comma and quotation marks is quoted; a grain without a name has its number."""
        odd = 'a, \\"b\\"'
        self.run_deck(start(10) + FLOOR + BLOCK.replace("block", odd) + disk("x", 1, 0.05).replace('name = "x"\n', "")
                      + EVERYTHING + "[[track]]\nbody = 2\n")
        self.assertEqual([row["body"] for row in self.rows()], ['a, "b"', "2", "floor"])

    def test_nothing_asked(self):
        """Without tracks there is no such file, and a former one goes."""
        self.run_deck(start() + FLOOR + BLOCK + EVERYTHING)
        self.run_deck(start() + FLOOR + BLOCK, "--force")
        self.assertFalse((self.place / "out" / "tracks.csv").exists())
        self.assertNotIn("file_tracks", self.run_json())
        done = self.run_deck(start() + FLOOR + BLOCK + EVERYTHING, "--force", "--set", "output.record_every=0")
        self.assertIn("[[track]] has no effect with output.record_every = 0", done.stderr)
        self.assertFalse((self.place / "out" / "tracks.csv").exists())

    def test_mistakes(self):
        """Names, patterns and numbers that no body has: sentence, place, caret, suggestion."""
        for word, sentence in (('"blok"', 'there is no body named "blok"; did you mean "block"?'),
                               ('"blo?"', 'no body has a name that matches "blo?"; the nearest one is "block"'),
                               ("7", "there is no body 7: the scene has 2"), ("true", '"body" must be the name or number of a body')):
            with self.subTest(word=word):
                said = self.run_deck(start() + FLOOR + BLOCK + f"[[track]]\nbody = {word}\n", code=2).stderr
                self.assertIn(sentence, said)
                self.assertRegex(said, r"deck\.toml:25:8: error: ")
                self.assertIn("       ^", said)
        said = self.run_deck(start() + disk("x", 0, 0).replace('name = "x"\n', "") + EVERYTHING, code=2).stderr
        self.assertIn("no body of this scene has a name, give its number", said)

    def test_datbox(self):
        """Next to a DATBOX bodies are tracked by number, and give what the deck itself gives."""
        self.run_deck(start() + FLOOR + BLOCK + EVERYTHING)
        self.run_program("convert", "deck.toml", "box")
        text = start().split("[[material]]")[0] + '[scene]\ndatbox = "box"\n' + "".join(f"[[track]]\nbody = {i}\n" for i in (1, 2))
        self.run_deck(text, output="other")
        for a, b in zip(self.rows(), self.rows(output="other"), strict=True):
            # Its numbers have eight digits.
            self.assertLess(abs(a["force_y"] - b["force_y"]), 1e-7 * WEIGHT)
            self.assertLess(abs(a["x"] - b["x"]), 1e-7)


if __name__ == "__main__":
    take_program()
    unittest.main()
