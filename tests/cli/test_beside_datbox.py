#!/usr/bin/env python3
"""Bodies of a deck next to those of a DATBOX: the same scene wholly native and in two halves, closed forms, ranks, restarts, mistakes."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program  # noqa: E402

TRILITH = Path(__file__).resolve().parents[2] / "input_decks/masonry/trilith.toml"
G = 9.81
RUN = """[time]
step = 1e-3
steps = 100
[solver]
criterion = "e8"
tolerance = 1e-12
maximum_sweeps = 20000
[output]
record_every = 10
"""
SPACE, PLANE = "[scene]\ndimension = 3\n", "[scene]\ndimension = 2\n"
STONE = '[[material]]\nname = "stone"\ndensity = 2500.0\n'
ROUGH = '[[law]]\nname = "rough"\nfriction = 0.6\n'
# Colours of at most five letters, as a DATBOX has them.
FLOOR = ('[[wall]]\nname = "floor"\ncentre = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nsize = [6.0, 6.0]\nthickness = 0.1\n'
         'colour = "floor"\nmaterial = "stone"\n')  # fmt: skip
PIER = '[[body]]\nname = "{}"\nshape = "box"\nhalf_axes = [0.1, 0.15, 0.2]\nposition = [{}, 0.0, 0.2]\ncolour = "pier"\n'
PIERS = PIER.format("left", 0.0) + PIER.format("right", 0.8)
GROUND = '[[wall]]\nname = "ground"\nfrom = [-2.0, -0.05]\nto = [4.0, -0.05]\nthickness = 0.1\ncolour = "floor"\nmaterial = "stone"\n'
# Of the solver (1e-12 of the largest impulse) over sums of a few contacts; numbers of a DATBOX have eight digits.
EXACT, DIGITS = 1e-9, 1e-6


def box_of(low, high, name):
    """A box as an object of an OBJ file."""
    (a, b, c), (d, e, f) = low, high
    points = [(a, b, c), (d, b, c), (d, e, c), (a, e, c), (a, b, f), (d, b, f), (d, e, f), (a, e, f)]
    sides = (1, 4, 3, 2), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8)
    return "\n".join([f"o {name}", *("v {} {} {}".format(*point) for point in points), *("f {} {} {} {}".format(*side) for side in sides)])


def tile(name, x, colour, speed=1.0, more=""):
    """A square that slides over the ground."""
    return (f'[[body]]\nname = "{name}"\nshape = "polygon"\nvertices = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]\n'
            f'position = [{x}, 0.1]\nvelocity = [{speed}, 0.0]\ncolour = "{colour}"\nmaterial = "stone"\n{more}')  # fmt: skip


class BesideDatbox(ProgramCase):
    def folder(self, text, name="BOX", *words):
        """Write the scene of a deck as a DATBOX, and give the beginning of a deck that uses it."""
        (self.place / "whole.toml").write_text(text)
        self.run_program("convert", "whole.toml", name, *words)
        return f'[scene]\ndatbox = "{name}"\n' + RUN

    def track(self, body, output="out"):
        return [{name: float(value) for name, value in row.items() if name not in ("body", "step")}
                for row in self.rows(output, "tracks.csv") if row["body"] == body]  # fmt: skip

    def same_tracks(self, ours, theirs, body, other=None, delta=EXACT, but=()):
        for one, two in zip(self.track(body, ours), self.track(other or body, theirs), strict=True):
            for name, value in one.items():
                if name not in but:
                    self.assertAlmostEqual(value, two[name], delta=delta * max(1.0, abs(value)), msg=(body, name))

    def on_several_ranks(self, ranks, text, bodies):
        """The deck on several ranks: the motion is that on one."""
        if not self.launcher:
            return
        self.on_ranks(ranks, text, "ranks")
        for body in bodies:
            self.same_tracks("out", "ranks", body)

    def goes_on(self, text, *files, output="on"):
        """A run that stops half way and goes on has the rows of the straight one, bit for bit."""
        if not self.has_hdf5():
            return
        self.run_deck(text, "--set", "time.steps=50", output="half")
        (self.place / "deck.toml").write_text(text)
        self.call("--restart", "half", "--quiet", output=output)
        for file in files:
            rows = self.rows(output, file)
            self.assertEqual([row for row in self.rows(file=file) if int(row["step"]) > 50], [row for row in rows if int(row["step"]) > 50])

    def test_blocks(self):
        """A beam of a mesh file on two piers of a folder: weights in closed form, the native scene, ranks, restarts."""
        (self.place / "beam.obj").write_text(box_of((-100, -150, 400), (900, 150, 500), "beam") + "\n")
        more = ('[[blocks]]\nfiles = "beam.obj"\nscale = 1e-3\nmaterial = "stone"\ncolour = "beam"\n[[track]]\nbody = "beam"\n'
                '[[interface]]\nbetween = [{}, "beam"]\n[[interface]]\nbetween = [{}, "beam"]\n')  # fmt: skip
        whole = SPACE + RUN + STONE + ROUGH + FLOOR + PIERS
        self.run_deck(whole + more.format('"left"', '"right"'), output="native")
        # In a folder a wall is numbered as in the deck, behind the bodies.
        half = self.folder(whole) + more.format(1, 2) + "[[interaction]]\n"
        self.run_deck(half)
        joints = self.rows(file="interfaces.csv")[-2:]
        weight = 2500 * 1.0 * 0.3 * 0.1 * G
        # Of rigid bodies the sum alone is unique.
        self.assertLessEqual(abs(sum(float(joint["normal_force"]) for joint in joints) - weight), DIGITS * weight)
        for joint in joints:
            self.assertAlmostEqual(float(joint["area"]), 0.06, delta=DIGITS)
        self.same_tracks("native", "out", "beam", delta=DIGITS)
        walls = self.rows(file="walls.csv")[-1]
        self.assertAlmostEqual(float(walls["force_z"]) / -(weight + 2 * 2500 * 0.2 * 0.3 * 0.4 * G), 1.0, delta=DIGITS)
        self.on_several_ranks(2, half, ["beam"])
        self.goes_on(half, "record.csv", "interfaces.csv", "tracks.csv")

    def test_trilith(self):
        """A lintel of a mesh file on two columns of a folder: the push at which it rocks, and how the rocking begins."""
        self.run_program("run", TRILITH, "--quiet", "--output", "out")
        width, height, column, lintel = 0.4, 2.0, 0.4 * 0.4 * 2.0, 2.6 * 0.4 * 0.3
        way = {round(row["time"], 6): row["x"] - 1.0 for row in self.track("lintel")}
        # Columns turn about their edges, the lintel stays level: its virtual work gives width over height, whatever the masses.
        rocks = min(time for time, x in way.items() if abs(x) > 1e-6)
        self.assertLess(max(abs(x) for time, x in way.items() if time <= 1.0), 1e-8)
        self.assertAlmostEqual((0.19 + 0.01 * rocks) / (width / height), 1.0, delta=3e-3)
        # The push grows by 0.01 g per second: the angle begins as the third power of time; turned edges add 1 % in 0.1 s.
        square = width**2 + height**2
        growth = 0.01 * G * height * (column + lintel) / (2 * column * square / 3 + lintel * square)
        self.assertAlmostEqual(way[1.09] / (height * growth * 0.09**3 / 6), 1.0, delta=1e-2)
        joints = self.rows(file="interfaces.csv")
        # At rest the columns bear it together.
        weight = 2400 * lintel * G
        self.assertAlmostEqual(sum(float(row["normal_force"]) for row in joints[:2]) / weight, 1.0, delta=1e-5)

    def test_see_tables_come_first(self):
        """A pair that a see table of the folder fits keeps its law; the interaction of the deck is for the others."""
        folder = self.folder(PLANE + RUN + STONE + ROUGH + GROUND + tile("old", 0.0, "tile"))
        law = '[[law]]\nname = "ice"\nkind = "IQS_CLB"\nfriction = 0.1\n'
        text = folder + tile("like", 1.0, "tile") + tile("other", 2.0, "other") + law + '[[interaction]]\nlaw = "ice"\n' \
            + "".join(f"[[track]]\nbody = {body}\n" for body in ('"like"', '"other"', 1))  # fmt: skip
        self.run_deck(text)
        for body, friction in (("1", 0.6), ("like", 0.6), ("other", 0.1)):
            self.assertAlmostEqual(self.track(body)[-1]["velocity_x"], 1 - friction * G * 0.1, delta=DIGITS)
        (self.place / "deck.toml").write_text((self.place / "out/effective.toml").read_text())
        self.call("--quiet", output="again")
        self.assertEqual(self.rows(file="tracks.csv"), self.rows("again", "tracks.csv"))
        # The scene of both is written as one folder.
        (self.place / "deck.toml").write_text(text)
        self.run_program("convert", "deck.toml", "BOTH")
        self.run_deck('[scene]\ndatbox = "BOTH"\n' + RUN + "".join(f"[[track]]\nbody = {body}\n" for body in (1, 3, 4)))
        for body, friction in (("1", 0.6), ("3", 0.6), ("4", 0.1)):
            self.assertAlmostEqual(self.track(body)[-1]["velocity_x"], 1 - friction * G * 0.1, delta=DIGITS)

    def test_links(self):
        """Rods between a body of a folder and one of the deck, between two of the deck, and between near points; a joint: as natively."""
        disk = '[[body]]\nname = "{}"\nshape = "disk"\nradius = 0.1\nposition = [{}, {}]\ncolour = "disk"\nmaterial = "stone"\n'
        point = '[[body]]\nname = "{}"\nshape = "point"\nmaterial = "stone"\nmass = 2.0\nposition = [{}, 0.0]\ncolour = "knot"\n'
        rod = '[[law]]\nname = "rod"\nkind = "ROD"\naxial_stiffness = 2e3\n'
        knots = '[[interaction]]\ncandidate_shape = "point"\nantagonist_shape = "point"\nlaw = "rod"\nalert = 0.6\n'
        contacts = '[[interaction]]\ncandidate = "disk"\nantagonist = "disk"\nlaw = "rough"\nalert = 0.01\n'
        old = disk.format("hook", 0.0, 0.0) + "fixed = true\n" + point.format("a", 1.0) + "fixed = true\n" + point.format("b", 1.5)
        new = disk.format("bob", 0.5, 0.0) + disk.format("low", 0.5, -0.5) + point.format("c", 2.0)
        link = '[[link]]\nbodies = [{}, {}]\nlaw = "rod"\n'
        links = link.format("{}", '"bob"') + link.format('"bob"', '"low"') + '[[joint]]\nbodies = ["low", {}]\npoint = [1.0, -0.5]\n'
        tracks = "".join(f'[[track]]\nbody = "{name}"\n' for name in ("bob", "low", "c"))
        head = PLANE + RUN + STONE + ROUGH + rod
        self.run_deck(head + old + new + knots + contacts + links.format('"hook"', '"a"') + tracks, output="native")
        text = self.folder(head + old + knots + contacts) + new + links.format(1, 2) + tracks
        self.run_deck(text)
        for body in ("bob", "low", "c"):
            # The see tables of the folder link its own points, and those of the deck to them.
            self.same_tracks("native", "out", body, delta=DIGITS)
            self.assertGreater(abs(self.track(body)[-1]["velocity_y"]), 0.1)
        self.on_several_ranks(2, text, ("bob", "low", "c"))
        self.goes_on(text, "record.csv", "tracks.csv")

    def test_bonds(self):
        """A stone of the deck glued under a fixed one of the folder, by a law of the deck: it hangs by weight over stiffness."""
        folder = self.folder(PLANE + RUN + STONE + ROUGH + tile("top", 0.0, "top", 0.0, "fixed = true\n"))
        glue = '[[law]]\nname = "glue"\nkind = "IQS_MAC_CZM"\nnormal_stiffness = 1e9\ntangential_stiffness = 1e9\nadhesion_energy = 10.0\n'
        stone = tile("stone", 0.0, "stone", 0.0).replace("position = [0.0, 0.1]", "position = [0.0, -0.1]")
        self.run_deck(folder + stone + glue + '[[bond]]\nbodies = [1, "stone"]\nlaw = "glue"\n[[track]]\nbody = "stone"\n')
        hangs = 2500 * 0.2 * 0.2 * G / (1e9 * 0.2)
        # The solver leaves 1e-12 of the impulse; a place of 0.1 m has 16 digits.
        self.assertAlmostEqual((-0.1 - self.track("stone")[-1]["y"]) / hangs, 1.0, delta=1e-8)

    def test_walls(self):
        """Two walls of a folder, two of the deck of which one is pressed, and grains of the deck: the rows and the cell of the native run."""
        wall = '[[wall]]\nname = "{}"\nfrom = [{}, {}]\nto = [{}, {}]\nthickness = 0.02\nmaterial = "stone"\n'
        old = wall.format("bottom", 0.0, 0.0, 1.0, 0.0) + wall.format("left", 0.0, 0.0, 0.0, 1.0)
        new = wall.format("right", 1.0, 0.0, 1.0, 1.0) + wall.format("top", 0.0, 1.0, 1.0, 1.0) \
            + "pressure = 1000.0\ndirection = [0.0, -1.0]\n[[sample]]\nbox = [0.05, 0.05, 0.95, 0.95]\nradius = [0.02, 0.03]\nfill = 0.4\n"
        self.run_deck(PLANE + RUN + STONE + ROUGH + old + new, output="native")
        # A folder of walls alone has no see table.
        text = self.folder(PLANE + RUN + STONE + ROUGH + old) + new + "[[interaction]]\n"
        self.assertNotIn("no see table", self.run_deck(text).stderr)
        names = [row["wall"] for row in self.rows(file="walls.csv")[-4:]]
        self.assertEqual(names, ["1", "2", "right", "top"])
        for ours, theirs in zip(self.rows(file="walls.csv"), self.rows("native", "walls.csv"), strict=True):
            for name in ("x", "y", "velocity_y", "force_y"):
                self.assertAlmostEqual(float(ours[name]), float(theirs[name]), delta=DIGITS * max(1.0, abs(float(theirs[name]))), msg=name)
        for name in ("cell_x", "cell_y", "strain_yy", "void_ratio"):
            self.assertAlmostEqual(float(self.rows()[-1][name]), float(self.rows("native")[-1][name]), delta=DIGITS, msg=name)

    def test_cell(self):
        """Grains of a folder in a periodic cell under stress and strain: as those of the deck itself, also on two ranks."""
        cells = {2: "[cell]\nsize = [1.0, 1.0]\nstress_xx = 1e4\nshear_rate = 0.5\n",
                 3: "[cell]\nsize = [1.0, 1.0, 1.0]\nstress_xx = 1e4\nstress_yy = 1e4\nstrain_rate_zz = 0.2\nshear_rate = 0.1\n"}  # fmt: skip
        for dimension, cell in cells.items():
            with self.subTest(dimension=dimension):
                scene, shape = (PLANE, "disk") if dimension == 2 else (SPACE, "sphere")
                scene += RUN.replace("steps = 100", "steps = 60")
                # Within the cell, where the places of a sample do not depend on periods.
                grains = f'[[sample]]\nbox = {[0.01] * dimension + [0.99] * dimension}\nshape = "{shape}"\nradius = [0.06, 0.08]\nfill = 0.3\n'
                self.run_deck(scene + STONE + ROUGH + grains + cell, output="native")
                text = self.folder(scene + STONE + ROUGH + grains, f"GRAINS{dimension}").replace("steps = 100", "steps = 60") + cell
                self.run_deck(text)
                names = ["kinetic_energy", "cell_x", "strain_xy", "stress_xx"]
                # Impacts enlarge what eight digits of a folder leave: the first rows alone.
                for ours, theirs in zip(self.rows()[:4], self.rows("native")):
                    for name in names:
                        self.assertAlmostEqual(float(ours[name]), float(theirs[name]), delta=10 * DIGITS * abs(float(theirs[name])), msg=name)
                self.assertGreater(int(self.rows()[-1]["contacts"]), 10)
                self.goes_on(text, "record.csv", output=f"on{dimension}")
                if self.launcher and dimension == 3:
                    self.on_ranks(2, text, "ranks")
                    for name in names:
                        self.assertAlmostEqual(float(self.rows("ranks")[3][name]) / float(self.rows()[3][name]), 1.0, delta=DIGITS, msg=name)

    def test_state(self):
        """A folder in the state of a run, with its contacts: grains of the deck fall beside it, which goes on as it would alone."""
        if not self.has_hdf5():
            return
        head = PLANE + RUN + STONE + ROUGH
        sample = '[[sample]]\nbox = {}\ncount = 20\nradius = [0.04, 0.06]\nmaterial = "stone"\ncolour = "{}"\nvelocity = [0.0, -1.0]\n'
        old = GROUND + tile("one", 0.0, "tile", 2.0) + tile("two", 0.25, "tile", 0.0) + sample.format([-2.0, 0.5, -1.0, 1.5], "dust")
        more = tile("three", 1.5, "new", 1.0) + sample.format([2.0, 0.5, 3.0, 1.5], "grain")
        # Bodies 1 to 23 are those of the folder.
        tracks = "".join(f"[[track]]\nbody = {body}\n" for body in (1, 2, 3, 24, 25, 44))
        contact = '[[interaction]]\nalert = 0.01\n'
        self.run_deck(head + old, output="start")
        state = self.folder(head + old, "STATE", "--restart", "start")
        text = state + more + contact + tracks
        self.run_deck(state + "".join(f"[[track]]\nbody = {body}\n" for body in (1, 2, 3)), output="alone")
        self.run_deck(text)
        self.assertAlmostEqual(float(self.rows()[0]["time"]), 0.11, delta=EXACT)
        for body in ("1", "2"):
            # Tiles side by side push each other by rounding, or not at all: those points count as contacts or do not.
            self.same_tracks("alone", "out", body, but=("contacts",))
        for body in ("25", "44"):
            self.assertAlmostEqual(self.track(body)[-1]["velocity_y"], -1 - G * 0.1, delta=DIGITS)
        self.assertAlmostEqual(self.track("three")[-1]["velocity_x"], 1 - 0.6 * G * 0.1, delta=DIGITS)
        self.on_several_ranks(3, text, ("1", "2", "three", "25", "44"))
        self.goes_on(text, "record.csv")

    def test_mistakes(self):
        """Names that are taken, laws that are not there, shapes in each other: sentence and place; what overlaps in the folder may."""
        old = STONE + ROUGH + GROUND + tile("old", 0.0, "tile") + tile("same", 0.05, "tile")
        head = self.folder(PLANE + RUN + old + '[[interaction]]\ncandidate = "tile"\nantagonist = "floor"\n')
        for more, sentence in (
            (STONE, 'the DATBOX has a material named "stone"'),
            ('[[law]]\nname = "rogh"\nfriction = 0.3\n', 'the DATBOX has no law named "rogh", and a law of the deck needs the key "kind"'),
            ('[[law]]\nname = "rough"\nfriction = 0.3\n', "adds moments against rolling or twisting alone"),
            (tile("new", 0.1, "tile") + "[[interaction]]\n", 'body 1 and "new" overlap at the start'),
            (tile("new", 1.0, "tile") + tile("new", 2.0, "tile"), 'there are two bodies named "new"'),
            (tile("new", 1.0, "tile") + '[[link]]\nbodies = [9, "new"]\n', "there is no body 9: the scene has 4"),
            ("[cell]\nsize = [9.0, 9.0]\n", "a periodic cell holds free grains alone"),
            ("[repeat]\ncount = 2\nshift = [9.0, 0.0]\n", "a DATBOX cannot be repeated"),
        ):  # fmt: skip
            said = self.run_deck(head + more, code=2).stderr
            self.assertIn(sentence, said)
            self.assertRegex(said, r"deck\.toml:\d+:\d+: error: .*\n.*\n *\^")
        lonely = tile("new", 1.0, "lone") + '[[law]]\nname = "ice"\nkind = "IQS_CLB"\n'
        said = self.run_deck(head + lonely).stderr
        self.assertIn("no see table fits POLYG of colour 'lone', which touches nothing; an [[interaction]]", said)
        self.assertIn("no interaction, no link and no bond names this law", said)
        hidden = tile("new", 1.0, "tile") + '[[interaction]]\ncandidate = "tile"\ncandidate_shape = "polygon"\nantagonist = "floor"\n' \
            'antagonist_shape = "segment"\n'  # fmt: skip
        self.assertIn("see tables of the DATBOX, which come first, take all shapes", self.run_deck(head + hidden).stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
