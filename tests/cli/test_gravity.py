#!/usr/bin/env python3
"""Gravity that changes with time: the fall of an arch against limit analysis, a free body, tables, energy, stages, restarts, ranks."""

import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from limit_analysis import load_multiplier  # noqa: E402
from program_case import ProgramCase, take_program  # noqa: E402

ARCH = Path(__file__).resolve().parents[2] / "input_decks" / "tilting_arch.toml"
STEP = 1e-2
STEPS = 100
# Sums of a hundred terms of order 1 in double precision.
ROUNDING = 1e-13
HEAD = f"""[time]
step = {STEP}
steps = {STEPS}
[output]
record_every = 1
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.3
"""
BALL = """[[body]]
name = "ball"
shape = "disk"
radius = 0.1
position = [0.0, 0.1]
[[track]]
body = "ball"
"""
BOX = """[[wall]]
from = [-0.1, -0.01]
to = [1.1, -0.01]
thickness = 0.02
[[wall]]
from = [-0.01, 0.0]
to = [-0.01, 1.0]
thickness = 0.02
[[wall]]
from = [1.01, 0.0]
to = [1.01, 1.0]
thickness = 0.02
[[sample]]
box = [0.0, 0.0, 0.8, 0.6]
kind = "lattice"
radius = 0.05
spacing = 1.05
"""


def gravity(component, value, *more, stage=False):
    """A block of gravity."""
    return "\n".join([f"[[{'stage.' if stage else ''}gravity]]", f'component = "{component}"', f"value = {value}", *more, ""])


def fall_of_arch(voussoirs, inner, outer, friction, fixed=1):
    """Tilt at which limit analysis lets a half round arch fall, some voussoirs of either end fixed [rad]; None where it cannot stand."""
    angles = [math.pi / 2 * (1 - 2 * i / voussoirs) for i in range(voussoirs + 1)]

    def at(radius, i):
        return (-radius * math.sin(angles[i]), radius * math.cos(angles[i]))

    blocks = [[at(inner, i), at(outer, i), at(outer, i + 1), at(inner, i + 1)] for i in range(fixed, voussoirs - fixed)]
    joints = [(k if k < len(blocks) else None, k - 1 if k > 0 else None, at(inner, k + fixed), at(outer, k + fixed),
               (math.cos(angles[k + fixed]), math.sin(angles[k + fixed]))) for k in range(len(blocks) + 1)]  # fmt: skip
    multiplier = load_multiplier(blocks, joints, friction)
    return None if multiplier is None else math.atan(multiplier)


class Gravity(ProgramCase):
    def test_limit_analysis(self):
        """The linear programme finds what is known: a block on a tilted plane slides at friction or turns at width over height."""
        block = [(0.0, 0.0), (0.5, 0.0), (0.5, 2.0), (0.0, 2.0)]
        for friction, wanted in ((0.2, 0.2), (0.7, 0.25)):
            found = load_multiplier([block], [(0, None, (0.0, 0.0), (0.5, 0.0), (0.0, 1.0))], friction)
            self.assertAlmostEqual(found, wanted, delta=1e-12)
        # The thinnest half round arch that stands has thickness 0.1075 of the mean radius.
        self.assertIsNotNone(fall_of_arch(24, 1 - 0.0545, 1 + 0.0545, 1.0, fixed=0))
        self.assertIsNone(fall_of_arch(24, 1 - 0.0525, 1 + 0.0525, 1.0, fixed=0))

    def test_tilting_arch(self):
        """The arch stands until the angle of limit analysis. Its speed then grows as the square of the time: where that began is
        the angle of collapse."""
        self.run_program("run", ARCH, "--output", "out", "--quiet", "--force")
        wanted = fall_of_arch(11, 0.85, 1.0, 1.0)
        rows = [(0.1 * float(row["time"]), float(row["max_velocity"])) for row in self.rows()]
        self.assertLess(max(speed for angle, speed in rows if angle < 0.98 * wanted), 2e-4)
        (a, slow), (b, fast) = [next(row for row in rows if row[1] > speed) for speed in (5e-3, 1.5e-2)]
        begin = a - (b - a) * math.sqrt(slow) / (math.sqrt(fast) - math.sqrt(slow))
        self.assertAlmostEqual(begin / wanted, 1.0, delta=0.01)
        self.assertLess(float(self.rows()[-1]["energy_closure"]), 1e-6)
        self.check_thrust(0.5 * (0.85 + 1.0), 0.5 * (1.0 - 0.85), wanted)

    def check_thrust(self, radius, half, collapse):
        """The thrust line stays within the joints, off their edges until half the angle of collapse; there it touches the edges at four
        joints, in and out in turns."""
        steps = {}
        for row in self.rows(file="interfaces.csv"):
            side = math.copysign(1, math.hypot(float(row["x"]), float(row["z"])) - radius)
            steps.setdefault(0.1 * float(row["time"]), []).append(side * float(row["eccentricity"]) / half)
            self.assertAlmostEqual(float(row["area"]), 0.2 * 2 * half, delta=1e-4 * 0.2 * half)
        self.assertEqual({len(shares) for shares in steps.values()}, {10})
        # Voussoirs turn by less than 1 mrad until the end, and the force acts off the middle of the depth by 3 % of it.
        self.assertLess(max(abs(share) for shares in steps.values() for share in shares), 1.005)
        self.assertLess(max(abs(share) for angle, shares in steps.items() if angle < 0.5 * collapse for share in shares), 0.9)
        # That angle is met within 1 %; just beyond it four joints have opened, and the others have not yet.
        at_collapse = next(shares for angle, shares in steps.items() if angle >= 1.01 * collapse)
        hinges = [share for share in at_collapse if abs(share) > 0.99]
        self.assertEqual([share > 0 for share in hinges], [False, True, False, True])

    def test_free_body(self):
        """A free body gains the mean gravity of each step, given by expressions, by a table, or between two times."""
        (self.place / "push.txt").write_text("0.0 1.0\n0.5 3.0\n1.0 -1.0\n")
        rule = (lambda t: 3 * math.sin(5 * t), lambda t: 1 + 4 * t if t < 0.5 else 3 - 8 * (t - 0.5))
        self.run_deck(HEAD + BALL + gravity("x", '"3*sin(5*t)"') + gravity("y", 0.0, 'file = "push.txt"'))
        speeds = [0.0, 0.0]
        for n, row in enumerate(self.rows(file="tracks.csv")):
            for c in range(2):
                speeds[c] += STEP * (rule[c](n * STEP) + rule[c]((n + 1) * STEP)) / 2
                self.assertAlmostEqual(float(row["velocity_" + "xy"[c]]), speeds[c], delta=ROUNDING)
        self.assertLess(float(self.rows()[-1]["energy_closure"]), 1e-12)
        # Outside its times the gravity of the scene holds.
        self.run_deck(HEAD + BALL + gravity("y", -1.0, "start = 0.2", "end = 0.5"))
        self.assertAlmostEqual(float(self.rows(file="tracks.csv")[-1]["velocity_y"]), -9.81 * 0.7 - 0.3, delta=1e-12)

    def test_space(self):
        """In space along z, in substeps."""
        ball = BALL.replace("disk", "sphere").replace("[0.0, 0.1]", "[0.0, 0.1, 0.2]")
        self.run_deck("[scene]\ndimension = 3\n" + HEAD + ball + gravity("z", '"-2*t"'), "--set", "time.substeps=4")
        self.assertAlmostEqual(float(self.rows(file="tracks.csv")[-1]["velocity_z"]), -1.0, delta=ROUNDING)
        self.assertLess(float(self.rows()[-1]["energy_closure"]), 1e-12)

    def test_grains(self):
        """Grains in a box that is tilted: the balance closes, a restart goes on to the byte, ranks find the same."""
        text = HEAD + BOX + gravity("x", '"9.81*sin(0.8*t)"') + gravity("y", '"-9.81*cos(0.8*t)"')
        words = ("--set", "restart.every=40", "--set", "restart.at_end=false", "--set", "solver.tolerance=1e-8")
        self.run_deck(text, *(words if self.has_hdf5() else words[-2:]))
        rows = self.rows()
        self.assertGreater(int(rows[-1]["contacts"]), 40)
        self.assertGreater(float(rows[-1]["impact_loss"]), 1.0)
        self.assertLess(float(rows[-1]["energy_closure"]), 1e-8)
        if self.has_hdf5():
            self.run_deck(text, *words, "--restart", "out/restart_a.h5", output="again")
            for key in ("kinetic_energy", "potential_energy", "friction_loss", "impact_loss", "energy_closure", "momentum_x"):
                self.assertEqual(self.rows(output="again")[-1][key], rows[-1][key], key)
        if not self.launcher:
            return
        # A part of the run, in which grains have come down and slide to one side.
        self.on_ranks(2, text, "ranks", "--set", "time.steps=50", *words[-2:])
        self.assertGreater(int(rows[49]["contacts"]), 40)
        self.assertGreater(float(rows[49]["impact_loss"]), 1.0)
        # Grains that roll and hit each other enlarge what the solver leaves.
        ratio = float(self.rows(output="ranks")[-1]["potential_energy"]) / float(rows[49]["potential_energy"])
        self.assertAlmostEqual(ratio, 1.0, delta=1e-3)
        self.assertLess(float(self.rows(output="ranks")[-1]["energy_closure"]), 1e-8)

    def test_stages(self):
        """Gravity of a stage takes the place of the deck's along its axis, and counts time from the start of the stage."""
        if not self.has_hdf5():
            self.skipTest("stages need HDF5")
        text = HEAD.replace(f"steps = {STEPS}\n", "") + BALL + gravity("x", 2.0)
        stages = '[[stage]]\nsteps = 50\n[[stage]]\nsteps = 50\n' + gravity("x", '"6*t"', stage=True) + '[[stage]]\nsteps = 50\n'
        self.run_deck(text + stages)
        ends = [float(row["velocity_x"]) for row in self.rows(file="tracks.csv")][-101::50]
        for found, wanted in zip(ends, (1.0, 1.75, 2.75), strict=True):
            self.assertAlmostEqual(found, wanted, delta=ROUNDING)
        self.assertLess(float(self.rows()[-1]["energy_closure"]), 1e-12)

    def test_mistakes(self):
        """One sentence for what cannot be."""
        cell = HEAD + "[cell]\nsize = [1.0, 1.0]\n" + BALL.split("[[track]]")[0]
        for text, sentence in (
            (HEAD + BALL + gravity("x", 1.0) + gravity("x", 2.0), "this component of gravity is given twice at a time"),
            (HEAD + BALL + gravity("z", 1.0), 'component'),
            (HEAD + BALL + gravity("x", '"1/t"'), "has no value at t = 0.0 s"),
            (cell + gravity("y", -9.81), "there is no gravity in a periodic cell"),
        ):
            done = self.run_deck(text, code=2)
            self.assertIn(sentence, done.stdout + done.stderr)
        (self.place / "deck.toml").write_text(HEAD + BALL + gravity("x", 1.0))
        done = self.run_program("convert", "deck.toml", "folder", code=2)
        self.assertIn("a DATBOX holds no gravity that changes with time", done.stdout + done.stderr)


if __name__ == "__main__":
    take_program()
    unittest.main()
