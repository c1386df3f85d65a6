#!/usr/bin/env python3
"""Bodies from mesh files: names, weights and joints of objects, one body of convex parts, files of one shape, several ranks, mistakes."""

import csv
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

G = 9.81
HEAD = """[scene]
dimension = 3
[time]
step = 1e-3
steps = 20
[solver]
criterion = "e8"
tolerance = 1e-12
maximum_sweeps = 20000
[output]
record_every = 20
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.6
"""
SIDES = ([1, 4, 3, 2], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8])
# Of the solver (1e-12 of the largest impulse), over sums of a few contacts.
EXACT = 1e-9


def corners(low, high):
    """Corners of a box: bottom, then top, counter-clockwise seen from above."""
    (a, b, c), (d, e, f) = low, high
    return [(a, b, c), (d, b, c), (d, e, c), (a, e, c), (a, b, f), (d, b, f), (d, e, f), (a, e, f)]


class Obj:
    """An OBJ file."""

    def __init__(self):
        self.lines, self.before = [], 0

    def box(self, low, high, head=None, sides=SIDES):
        self.lines += [head] if head else []
        self.lines += ["v {} {} {}".format(*corner) for corner in corners(low, high)]
        self.lines += ["f " + " ".join(str(corner + self.before) for corner in side) for side in sides]
        self.before += 8
        return self

    def write(self, path):
        path.parent.mkdir(exist_ok=True)
        path.write_text("\n".join(self.lines) + "\n")


def stl(low, high):
    """A box as STL text."""
    points, lines = corners(low, high), ["solid box"]
    for a, b, c, d in SIDES:
        for triangle in ((a, b, c), (a, c, d)):
            lines += ["facet normal 0 0 0", "outer loop", *("vertex {} {} {}".format(*points[k - 1]) for k in triangle), "endloop",
                      "endfacet"]
    return "\n".join([*lines, "endsolid box"]) + "\n"


class Blocks(ProgramCase):
    def run_deck(self, text, *words, output="out", code=0):
        return super().run_deck(HEAD + text, *words, output=output, code=code)

    def joints(self, output="out"):
        with (self.place / output / "interfaces.csv").open(newline="") as lines:
            return {(row["first"], row["second"]): row for row in csv.DictReader(lines)}

    def weighs(self, joint, wanted):
        self.assertLessEqual(abs(float(joint["normal_force"]) - wanted), EXACT * wanted)

    def test_objects(self):
        """A beam on two piers of one file, on a floor of another one, in millimetres: names, weights, areas."""
        pile = Obj().box((0, 0, 0), (200, 300, 400), "o pier.left").box((800, 0, 0), (1000, 300, 400), "o pier.right")
        # The last object has its faces clockwise.
        pile.box((0, 0, 400), (1000, 300, 500), "o the beam", [side[::-1] for side in SIDES]).write(self.place / "obj" / "pile.obj")
        Obj().box((-500, -500, -100), (1500, 800, 0)).write(self.place / "obj" / "floor.obj")
        self.run_deck('[[blocks]]\nfiles = "obj/*.obj"\nscale = 1e-3\nfixed = "floor"\n[[interface]]\n')
        joints = self.joints()
        self.assertEqual(set(joints), {("floor", "pier.left"), ("floor", "pier.right"), ("pier.left", "the beam"), ("pier.right", "the beam")})
        beam, pier = 2500 * 1.0 * 0.3 * 0.1 * G, 2500 * 0.2 * 0.3 * 0.4 * G
        above, below = ([joints[pair] for pair in joints if side in pair] for side in ("the beam", "floor"))
        # Of rigid bodies their sums alone are unique.
        self.assertLessEqual(abs(sum(float(joint["normal_force"]) for joint in above) - beam), EXACT * beam)
        self.assertLessEqual(abs(sum(float(joint["normal_force"]) for joint in below) - beam - 2 * pier), EXACT * beam)
        for side in ("left", "right"):
            self.assertAlmostEqual(float(joints["floor", f"pier.{side}"]["area"]), 0.06, delta=1e-9)
        self.assertAlmostEqual(float(joints["pier.left", "the beam"]["middle_z"]), 0.4, delta=1e-6)
        # Names may be called by patterns, and have another begin.
        self.run_deck('[[blocks]]\nname = "house"\nfiles = ["obj/pile.obj", "obj/floor.obj"]\nscale = 1e-3\nfixed = ["*floor"]\n'
                      'position = [5.0, 0.0, 0.0]\n[[interface]]\nbetween = ["house.pier.*", "house.the beam"]\n')
        moved = self.joints()
        self.assertEqual(len(moved), 2)
        self.assertAlmostEqual(float(moved["house.pier.left", "house.the beam"]["middle_x"]), 5.1, delta=1e-6)

    def test_convex_parts(self):
        """Two groups of one object are one rigid body: an L that would fall in two rests, and weighs both."""
        # The arm overhangs: alone it would turn about the edge of the foot, and with the foot below its centre it does not.
        shape = Obj().box((0, 0, 0), (0.5, 0.2, 0.1), "o hook\ng convex_1").box((0, 0, 0.1), (0.1, 0.2, 0.5), "g convex_2")
        shape.box((0.1, 0, 0.4), (0.6, 0.2, 0.5), "g convex_3").write(self.place / "obj" / "hook.obj")
        (self.place / "obj" / "floor.stl").write_text(stl((-1, -1, -0.1), (1, 1, 0)))
        self.run_deck('[[blocks]]\nfiles = ["obj/hook.obj", "obj/floor.stl"]\nfixed = "floor"\n[[interface]]\n')
        joints = self.joints()
        self.assertEqual(set(joints), {("hook", "floor")})
        volumes = 0.5 * 0.2 * 0.1, 0.1 * 0.2 * 0.4, 0.5 * 0.2 * 0.1
        self.weighs(joints["hook", "floor"], 2500 * sum(volumes) * G)
        centre = (volumes[0] * 0.25 + volumes[1] * 0.05 + volumes[2] * 0.35) / sum(volumes)
        self.assertAlmostEqual(float(joints["hook", "floor"]["x"]), centre, delta=EXACT)
        self.assertAlmostEqual(float(joints["hook", "floor"]["area"]), 0.1, delta=EXACT)

    def test_same_as_body(self):
        """Bytes of the record are those of bodies that name the same files, on one rank and in three parts."""
        (self.place / "low.stl").write_text(stl((0, 0, 0), (0.3, 0.3, 0.1)))
        (self.place / "high.stl").write_text(stl((0.05, 0.1, 0.12), (0.2, 0.3, 0.3)))
        floor = '[[wall]]\nname = "floor"\ncentre = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nsize = [6.0, 6.0]\nthickness = 0.1\n'
        own = "".join(f'[[body]]\nname = "{name}"\nshape = "polyhedron"\nfile = "{name}.stl"\n' for name in ("low", "high"))
        for words in ((), ("--set", "partition.parts=3")):
            self.run_deck(own + floor + "[[interface]]\n", *words, output="bodies")
            self.run_deck('[[blocks]]\nfiles = ["low.stl", "high.stl"]\n' + floor + "[[interface]]\n", *words, output="blocks")
            for file in ("record.csv", "interfaces.csv"):
                self.assertEqual(self.rows("bodies", file), self.rows("blocks", file))
        if self.launcher:
            self.on_ranks(3, HEAD + '[[blocks]]\nfiles = ["low.stl", "high.stl"]\n' + floor + "[[interface]]\n", "ranks",
                          "--set", "partition.parts=3")
            self.assertEqual(self.rows("ranks", "interfaces.csv"), self.rows("blocks", "interfaces.csv"))

    def test_mistakes(self):
        """What is not convex, not closed, not there or named twice: sentence and place."""
        shape = Obj().box((0, 0, 0), (1, 1, 1), "o block")
        shape.lines[-4] = shape.lines[-4].replace("f ", "# ")
        shape.write(self.place / "open.obj")
        dented = Obj().box((0, 0, 0), (1, 1, 1), "o dented", SIDES[:1] + SIDES[2:])
        dented.lines += ["v 0.5 0.5 0.6"] + [f"f {a} {b} 9" for a, b in ((5, 6), (6, 7), (7, 8), (8, 5))]
        dented.write(self.place / "dented.obj")
        Obj().box((0, 0, 0), (1, 1, 1), "o one").box((2, 0, 0), (3, 1, 1), "o one").write(self.place / "twice.obj")
        for file, sentences in (("dented.obj", ('"dented": the shape is not convex', '"splitgrain convex ', "divides it into convex parts")),
                                ("open.obj", ('"block": ', "edge")), ("none*.obj", ('no file matches "none*.obj"',)),
                                ("twice.obj", ('there are two bodies named "one"',))):
            said = self.run_deck(f'[[blocks]]\nfiles = "{file}"\n', code=2).stderr
            for sentence in sentences:
                self.assertIn(sentence, said)
            self.assertRegex(said, r"deck\.toml:1[78]:")
        if self.has_library("Qhull"):
            self.run_deck('[[blocks]]\nfiles = "dented.obj"\nhull = true\n')

    def test_command(self):
        """The Python package divides meshes, where there is one."""
        done = subprocess.run([self.program, "convex", self.place / "none.obj"], capture_output=True, text=True, timeout=self.timeout)
        self.assertIn((done.returncode, "none.obj" in done.stderr, "needs Python" in done.stderr), ((2, True, False), (1, False, True)))


if __name__ == "__main__":
    take_program()
    unittest.main()
