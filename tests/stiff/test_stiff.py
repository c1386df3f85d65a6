#!/usr/bin/env python3
"""Stiff and extreme cases that are quick: decks of input_decks/extreme, with what must come out.

usage: test_stiff.py PROGRAM [unittest options]

Known limits are asserted as what must then happen: which sentence, which exit code, no value that is not finite.
"""

import csv
import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program

DECKS = Path(__file__).resolve().parents[2] / "input_decks" / "extreme" / "decks"
MATRICES = ("accelerated", "proximal", "interior", "auto")
SWEEPS = ("nlgs", "nesterov")
SOLVERS = SWEEPS + MATRICES
G = 9.81


class Stiff(ProgramCase):
    def run_deck(self, deck, code=0, **settings):
        """run.json of a deck with settings; dots in their names are written as two underscores, blocks as _2_."""
        words = []
        for name, value in settings.items():
            words += ["--set", f"{self.key(name)}={value}"]
        self.said = self.run_program("run", DECKS / f"{deck}.toml", "--output", "out", "--force", "--quiet", *words, code=code).stderr
        run = json.loads((self.place / "out" / "run.json").read_text())
        # A value that is not finite is null there.
        self.assertEqual([name for name, value in run.items() if value is None], [])
        self.check_record()
        return run

    def need_hulls(self):
        """Polyhedra of these decks are hulls of points."""
        if not self.has_library("Qhull"):
            self.skipTest("built without Qhull")

    def check_record(self):
        """Nothing that was recorded is infinite or no number."""
        with open(self.place / "out" / "record.csv", newline="") as file:
            for row in csv.DictReader(file):
                self.assertEqual([name for name, word in row.items() if not math.isfinite(float(word))], [])

    @staticmethod
    def key(name):
        """body_2__radius is body[2].radius."""
        section, key = name.split("__")
        head, _, number = section.rpartition("_")
        return f"{head}[{number}].{key}" if number.isdigit() else f"{section}.{key}"

    def assert_near(self, value, expected, tolerance):
        self.assertLessEqual(abs(value - expected), tolerance, f"{value} is not {expected}")


class Ratios(Stiff):
    def test_mass_ratio(self):
        """The floor carries the weight: e8 1e-6 leaves 1e-6 of it, and stacks of two a hundred times that."""
        for deck in ("two_blocks", "two_boxes"):
            for method in MATRICES[2:]:
                for heavy in ("material_1__density", "material_2__density"):
                    run = self.run_deck(deck, **{heavy: 1e9, "solver__method": method})
                    self.assertEqual(run["unconverged_steps"], 0)
                    self.assert_near(run["floor_share"], 1, 1e-4)
            run = self.run_deck(deck, material_1__density=1e11)
            self.assertEqual(run["unconverged_steps"], 0)
            self.assert_near(run["floor_share"], 1, 1e-6)

    def test_sweeps_at_a_mass_ratio_beyond_them_say_so(self):
        """Heavy on light at 1e8 is beyond sweeps: steps are counted, or the first of them ends the run with its dump."""
        run = self.run_deck("two_blocks", material_2__density=1e11)
        self.assertGreater(run["unconverged_steps"], 0)
        run = self.run_deck("two_blocks", code=3, material_2__density=1e11, solver__stop_unconverged="true")
        self.assertEqual(run["status"], "not converged")
        self.assertIn("did not converge", run["reason"])
        if self.has_hdf5():
            dump = self.place / "out" / f"dump-{run['steps']}-local.hdf5"
            self.assertIn("yes", self.run_program("solve", dump, "--solver", "auto").stdout)

    def test_free_fall_is_not_converged(self):
        """Plain sweeps, mass ratio 1e6: where they leave the heavy block in free fall, the step is named, whatever the criterion."""
        heavy = {"material_2__density": 1e9, "solver__criterion": '"estimate"', "solver__tolerance": 2e-2, "output__record_every": 1,
                 "solver__method": '"nlgs"'}  # fmt: skip
        run = self.run_deck("two_blocks", **heavy)
        self.assertGreater(run["unconverged_steps"], 50)
        self.assertEqual({run["worst_body_1"], run["worst_body_2"]}, {1, 2})
        self.assertGreater(run["worst_speed"], G * 1e-3)
        with open(self.place / "out" / "record.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        # Half of what contacts close with is allowed; blocks touch at two points, whose rms is less.
        self.assertLessEqual(max(float(row["violation"]) for row in rows if row["converged"] == "1"), 0.5)
        run = self.run_deck("two_blocks", code=3, solver__stop_unconverged="true", **heavy)
        self.assertIn(f"step {run['steps']} did not converge: the contact of bodies", run["reason"])
        verdict = self.run_program("run", DECKS / "two_blocks.toml", "--output", "said", "--set", "material[2].density=1e9").stdout
        self.assertRegex(verdict, r"worst step +\d+: the contact of bodies \d and \d breaks its law by .* g h")
        self.assertIn('solver.method = "auto"', verdict)

    def test_size_ratio(self):
        """Radii 1 to 1e4, masses 1 to 1e12 in space. Tolerance as above, for a pile that leans on friction.

        Rounding leaves 1e-16 * 1e12 of e1, so that no method meets its tolerance and turns of methods end with their iterations:
        the weight is then off by no more than the violation of the verdict, a tenth of what counts as converged.
        """
        small = 1e-5
        aside = 1.3 * math.sqrt(0.1 * small)
        top = small + math.sqrt((0.1 + small) ** 2 - aside**2)
        places = {f"body_{i + 1}__position": [aside * math.cos(a), aside * math.sin(a), small]
                  for i, a in enumerate((0, 2 * math.pi / 3, -2 * math.pi / 3))}  # fmt: skip
        radii = {f"body_{i}__radius": small for i in (1, 2, 3)}
        for method in ("accelerated", "auto", "interior"):
            run = self.run_deck("large_on_small_space", solver__method=method, body_4__position=[0.0, 0.0, top], **places, **radii)
            self.assertEqual(run["unconverged_steps"], 0)
            self.assertLess(run["worst_violation"], 0.05)
            self.assert_near(run["floor_share"], 1, max(1e-3, run["worst_violation"]) if method == "auto" else 1e-3)

    def test_column_of_two_hundred(self):
        run = self.run_deck("column_of_disks", solver__method="auto", sample__count=200, sample__box=[0.0, 0.0, 0.2, 40.001],
                            time__steps=5)  # fmt: skip
        self.assertEqual(run["unconverged_steps"], 0)
        self.assert_near(run["floor_share"], 1, 1e-2)


class Units(Stiff):
    """Lengths by s, times by sqrt(s), so that gravity stays: the same sweeps, the same numbers without units."""

    @staticmethod
    def scaled(s):
        t = math.sqrt(s)
        walls = (([0, -0.05], [1, -0.05]), ([-0.05, -0.2], [-0.05, 2]), ([1.05, -0.2], [1.05, 2]))
        ends = {f"wall_{i}__{name}": [s * x for x in place] for i, wall in enumerate(walls, 1)
                for name, place in zip(("from", "to"), wall, strict=True)}  # fmt: skip
        return {"sample__box": [0.0, 0.0, s, s], "sample__radius": [0.05 * s, 0.08 * s], "time__step": 1e-3 * t,
                "wall__thickness": 0.1 * s, "time__steps": 100, **ends}  # fmt: skip

    def test_grains_from_a_micrometre_to_a_thousand_kilometres(self):
        """With powers of two every number scales without rounding: all counts are equal, and all ratios to the last bits."""
        for method in (*SWEEPS, "accelerated", "proximal", "auto"):
            runs = {k: self.run_deck("polygons_in_a_box", solver__method=method, **self.scaled(2.0**k)) for k in (-20, 0, 20)}
            for k in (-20, 20):
                for count in ("sweeps", "contacts", "unconverged_steps", "contact_updates"):
                    self.assertEqual(runs[k][count], runs[0][count], f"{method}, 2^{k}, {count}")
                self.assertEqual(runs[k]["unconverged_steps"], 0)
                # Matrices are scaled where masses are far from a kilogram: their sums round otherwise.
                self.assert_near(runs[k]["floor_share"] / runs[0]["floor_share"], 1, 1e-12 if method in SWEEPS else 1e-6)
                self.assert_near(runs[k]["kinetic_energy"] / runs[0]["kinetic_energy"] / 2.0 ** (3 * k), 1, 1e-6)

    def test_decimal_scales(self):
        """Scales that round: sweeps stay the same."""
        sweeps = {s: self.run_deck("polygons_in_a_box", **self.scaled(s))["sweeps"] for s in (1e-6, 1.0, 1e6)}
        self.assertEqual(len(set(sweeps.values())), 1, sweeps)

    @staticmethod
    def scaled_in_space(s, radius, steps):
        return {"sample__box": [0.0, 0.0, 0.0, s, s, s], "sample__radius": [radius * s, 1.5 * radius * s],
                "container__size": [s, s, 2 * s], "container__thickness": 0.1 * s, "time__step": 1e-3 * math.sqrt(s),
                "time__steps": steps}  # fmt: skip

    def compare_in_space(self, deck, *scales):
        """Powers of two: all counts are equal; but matrices stop on e1, which weighs impulses and velocities by one mobility, known
        to a factor of four: a sweep in a hundred more or less. Scales that round: the same sweeps."""
        for method in (*SWEEPS, "auto"):
            runs = {k: self.run_deck(deck, solver__method=method, **self.scaled_in_space(2.0**k, *scales)) for k in (-20, 0, 20)}
            self.assertGreater(runs[0]["active_contacts"], 10)
            for k in (-20, 20):
                for count in ("contacts", "active_contacts", "unconverged_steps"):
                    self.assertEqual(runs[k][count], runs[0][count], f"{deck}, {method}, 2^{k}, {count}")
                for count in ("sweeps", "contact_updates"):
                    self.assert_near(runs[k][count] / runs[0][count], 1, 0 if method in SWEEPS else 1e-2)
                self.assertEqual(runs[k]["unconverged_steps"], 0)
                self.assert_near(runs[k]["kinetic_energy"] / runs[0]["kinetic_energy"] / 2.0 ** (4 * k), 1,
                                 1e-12 if method in SWEEPS else 1e-6)
        sweeps = {s: self.run_deck(deck, **self.scaled_in_space(s, *scales))["sweeps"] for s in (1e-6, 1.0, 1e6)}
        self.assertEqual(len(set(sweeps.values())), 1, f"{deck}, {sweeps}")

    def test_spheres(self):
        self.compare_in_space("spheres_in_a_box", 0.08, 200)

    def test_polyhedra(self):
        self.need_hulls()
        self.compare_in_space("polyhedra_in_a_box", 0.1, 200)

    def test_interior_points_converge_in_all_units(self):
        """Their path depends on the scale of impulses, so that iterations may differ, not that they arrive."""
        for k in (-20, 0, 20):
            run = self.run_deck("polygons_in_a_box", solver__method="interior", **self.scaled(2.0**k))
            self.assertEqual(run["unconverged_steps"], 0)
            self.assert_near(run["floor_share"], 0.1499, 1e-3)


class Laws(Stiff):
    def test_friction(self):
        """On a slope of 30 degrees: without friction and with next to none the closed form of free sliding, else at rest."""
        for friction, speed in ((0, 4.905 * 0.25), (1e-8, 4.905 * 0.25), (1, 0), (10, 0), (100, 0), (1000, 0)):
            for method in SOLVERS:
                run = self.run_deck("block_on_slope", law__friction=friction, solver__method=method, time__steps=250)
                self.assert_near(run["max_velocity"], speed, 5e-6)
                self.assertEqual(run["unconverged_steps"], 0)

    def test_friction_of_a_hundred_stops_clearly(self):
        """Sweeps do not converge on jammed polygons then: the run says so, ends with code 3 where it is asked to, and stays finite."""
        run = self.run_deck("polygons_in_a_box", law__friction=100, time__steps=250)
        self.assertGreater(run["unconverged_steps"], 0)
        run = self.run_deck("polygons_in_a_box", code=3, law__friction=100, time__steps=250, solver__stop_unconverged="true")
        self.assertIn("did not converge", run["reason"])

    def test_linear_law(self):
        """A disk that sinks, v' = (v - g h)/(1 + 1/(m epsilon)), to the rounding of fifty steps: what is left of g h is this share."""
        mass = 1000 * math.pi * 0.01
        for share in (1e-8, 1e-4, 1.0, 1e3):
            a = 1 / (1 + 1 / share)
            speed = G * 1e-3 * a * (1 - a**50) / (1 - a)
            run = self.run_deck("disk_on_dampers", law__epsilon=share / mass)
            self.assert_near(run["max_velocity"] / speed, 1, 1e-12 + 1e-14 / share)

    def test_restitution_and_the_cradle(self):
        """One ball on four that lie in a row: by Newton's law of impact all five contacts meet at once, by gaps one after the other."""
        mass = 7800 * math.pi * 0.01
        # A law of impacts acts where gaps are closed: all are, by a rounding.
        together = {f"body_{i}__position": [0.1 + (0.2 - 1e-12) * (i - 1), 0.0] for i in range(1, 6)} | {"time__steps": 1}
        for restitution, kept in ((0, 1 / 5), (1, 1)):
            # e = 0: all move with v/5; e = 1: the first with -3/5, the others with 2/5, which keeps the energy.
            run = self.run_deck("row_of_balls", law__normal_restitution=restitution, **together)
            self.assert_near(run["kinetic_energy"] / (mass / 2), kept, 1e-9)
            self.assert_near(run["momentum_x"] / mass, 1, 1e-9)
        run = self.run_deck("row_of_balls", law__normal_restitution=0.5, **together)
        self.assertLess(run["kinetic_energy"], mass / 2)
        gaps = {f"body_{i}__position": [0.3 + 0.2037 * (i - 2), 0.0] for i in (2, 3, 4, 5)}
        run = self.run_deck("row_of_balls", **gaps)
        self.assert_near(run["kinetic_energy"] / (mass / 2), 1, 1e-9)
        self.assert_near(run["max_velocity"], 1, 1e-9)

    def test_cohesion_beyond_weight(self):
        """A ball hangs while its cohesion is above its weight; below, it falls by h g a step less what cohesion holds."""
        weight = 1000 * math.pi * 0.01 * G
        for share, speed in ((1e6, 0), (1.01, 0), (0.5, None)):
            run = self.run_deck("ball_under_ceiling", law__normal_cohesion=share * weight)
            if speed is None:
                self.assertGreater(run["max_velocity"], 0.05)
            else:
                self.assert_near(run["max_velocity"], speed, 1e-9)

    def test_vibration(self):
        """A ball leaves a shaken floor when its acceleration is above gravity, at any frequency; impacts then take energy."""
        for frequency in (1, 35, 1000):
            for share in (0.95, 1.2):
                run = self.run_deck("shaken_ball", drive__frequency=frequency, time__step=1 / (500 * frequency),
                                    drive__amplitude=share * G / (2 * math.pi * frequency), time__steps=1000)  # fmt: skip
                speed = G / (2 * math.pi * frequency)
                lost = run["impact_loss"] / (7800 * math.pi * 0.01 * speed**2)
                self.assertEqual(lost > 1e-6, share > 1, lost)
                self.assertLess(run["energy_closure"], 1e-9)


class Motions(Stiff):
    def test_a_long_rest(self):
        """Three grains lie still: nothing drifts, nothing creeps: over 40,000 steps heights stay to 4e-14, 1e-18 of them per step."""
        steps = 40000 if "ffpe-trap" not in self.run_program("--version").stdout else 20000
        begin = self.run_deck("large_on_small", time__steps=100, time__step=1e-3)
        run = self.run_deck("large_on_small", time__steps=steps, time__step=1e-3, output__record_every=20000)
        self.assertEqual(run["steps"], steps)
        self.assertEqual(run["unconverged_steps"], 0)
        self.assertLess(run["max_velocity"], 1e-9)
        self.assertLess(run["worst_penetration"], 1e-9)
        self.assert_near(run["potential_energy"] / begin["potential_energy"], 1, 4e-14)

    def test_time_steps(self):
        """At rest from a picosecond to ten seconds."""
        for step in (1e-12, 1e-9, 1e-6, 1e-3, 1.0, 10.0):
            run = self.run_deck("ball_on_floor", time__step=step)
            self.assert_near(run["floor_share"], 1, 1e-6)
            self.assertLess(run["worst_penetration"], 1e-9)

    def test_what_lies_on_a_slope_does_not_creep(self):
        """Five hundred steps: what moves is what the tolerance leaves, 1e-6 of gravity times the step, and is not summed. e8 is a root
        mean square over the eight contacts, one of which may have all of it: sqrt(8) times as much."""
        tilt = [G * math.sin(0.3), 0.0, -G * math.cos(0.3)]
        for method in SOLVERS:
            for deck, more in (("block_on_slope", {"law__friction": 0.7}), ("two_boxes", {"scene__gravity": tilt})):
                run = self.run_deck(deck, solver__method=method, time__steps=500, **more)
                self.assertEqual(run["unconverged_steps"], 0)
                self.assertLess(run["max_velocity"], math.sqrt(8) * 1e-6 * G * 1e-3, f"{deck}, {method}")

    def test_an_impact_that_crosses_a_grain_in_a_step(self):
        """At 300 m/s the ball moves by three radii a step: found late, it is stopped in the wall, and the report says how deep."""
        run = self.run_deck("ball_on_floor", body_1__position=[0.0, 0.811], body_1__velocity=[0.0, -300.0], time__steps=10)
        self.assertLess(run["max_velocity"], 1)
        self.assertLess(run["worst_penetration"], 0.31)

    def test_a_ball_that_passes_another_one_is_told(self):
        """Balls whose law waits for the touch: at 2000 m/s one is found behind the other; the warning says which step would do."""
        far = {f"body_{i}__position": [0.0, -1e4 * i] for i in (3, 4, 5)}
        for speed, passings in ((1000.0, 0), (2000.0, 1)):
            settings = {"body_1__position": [-2.37e-3 * speed, 0.0], "body_1__velocity": [speed, 0.0], "body_2__position": [0.2, 0.0],
                        "law__normal_restitution": 0.0, "time__steps": 5, **far}  # fmt: skip
            run = self.run_deck("row_of_balls", **settings)
            self.assertEqual(run["passings"], passings)
            if passings:
                self.assertIn("warning: step 3: bodies 1 and 2 pass through each other, at 2.00E+03 m/s", self.said)
                self.assertIn("a time step below 1.0E-04 s finds them", self.said)
                self.assert_near(run["momentum_x"] / (7800 * math.pi * 0.01), speed, 1e-9 * speed)
                run = self.run_deck("row_of_balls", **settings | {"time__step": 0.99e-4, "time__steps": 50})
                self.assertEqual(run["passings"], 0)
            self.assertNotIn("pass", "" if passings else self.said)

    def test_fast_spin(self):
        """A free box at 1000 rad/s, one radian a step, keeps its energy; a sphere on a floor rolls or slides as it must."""
        run = self.run_deck("spinning_box", body_1__spin=[1e3, 1e2, 1e2])
        self.assertLess(run["energy_closure"], 1e-9)
        run = self.run_deck("spinning_sphere_on_floor", body_1__spin=[0.0, 1e6, 0.0])
        self.assert_near(run["mean_velocity"], 0.5 * G * 0.5, 0.005 * 0.25 * G)

    def test_a_full_box_that_is_crushed(self):
        """There is no solution: steps do not converge, and say so; what is found stays finite and deepens as the lid comes."""
        run = self.run_deck("full_box", time__steps=30, wall_4__velocity=[0.0, -0.1], solver__maximum_sweeps=100)
        self.assertGreater(run["unconverged_steps"], 0)
        self.assertLess(run["worst_penetration"], 2 * 0.1 * 0.03)
        run = self.run_deck("full_box", code=3, wall_4__velocity=[0.0, -0.1], solver__maximum_sweeps=100,
                            solver__stop_unconverged="true")  # fmt: skip
        self.assertEqual(run["status"], "not converged")

    def test_sudden_reversal_of_a_load(self):
        """Down, up at once, down again: the lid comes back, and the balance closes."""
        run = self.run_deck("pressed_box")
        self.assertLess(run["energy_closure"], 1e-8)
        self.assertLess(run["worst_penetration"], 0.05 * 0.05)


class Geometry(Stiff):
    def test_overlap_of_a_tenth(self):
        """Overlaps up to a tenth of the radius are warned of and stay, without energy; deeper ones, coincident centres, are refused."""
        run = self.run_deck("ball_on_floor", body_1__position=[0.0, 0.0901])
        self.assertIn("overlap at the start", self.said)
        self.assert_near(run["worst_penetration"], 0.0099, 1e-6)
        self.assertLess(run["kinetic_energy"], 1e-12)
        for deck, place in (("two_blocks", [0.0, 0.1]), ("two_boxes", [0.0, 0.0, 0.1])):
            said = self.run_program("run", DECKS / f"{deck}.toml", "--output", "out", "--force", "--set", f"body[2].position={place}", code=2)
            self.assertIn("overlap at the start", said.stderr)
            self.assertNotIn("NaN", said.stderr)

    def test_slivers_and_needles(self):
        """A sliver of aspect 1e4 and a needle of 1e3 lie on a floor."""
        sliver = "[[-0.1, -1e-5], [0.1, -1e-5], [0.1, 1e-5], [-0.1, 1e-5]]"
        run = self.run_deck("block_on_slope", body_1__vertices=sliver, body_1__position=[0.0, 1e-5], scene__gravity=[0.0, -G],
                            time__step=1e-4, time__steps=50)  # fmt: skip
        self.assert_near(run["floor_share"], 1, 1e-3)
        self.assertLess(run["worst_penetration"], 1e-8)
        run = self.run_deck("two_boxes", body_1__half_axes=[0.1, 1e-4, 1e-4], body_1__position=[0.0, 0.0, 1e-4],
                            body_2__half_axes=[0.1, 1e-4, 1e-4], body_2__position=[0.0, 0.0, 3e-4], time__step=1e-4)  # fmt: skip
        self.assert_near(run["floor_share"], 1, 1e-3)


class Interlocked(Stiff):
    """Blocks that lock each other by their shapes stand without friction."""

    def assert_stands(self, run, unconverged=0):
        self.assertLessEqual(run["unconverged_steps"], unconverged * run["steps"])
        self.assert_near(run["floor_share"], 1, 1e-3)
        self.assertLess(run["max_velocity"], 1e-4)

    def test_key_in_a_slot(self):
        """Wherever gravity points, it moves by its play of a centimetre, and is at rest: free, it would fall by 1.2 m."""
        for angle in range(0, 360, 30):
            gravity = [G * math.sin(math.radians(angle)), -G * math.cos(math.radians(angle))]
            run = self.run_deck("key_in_a_slot", scene__gravity=gravity)
            self.assertEqual(run["unconverged_steps"], 0)
            self.assertLess(run["max_velocity"], 1e-3, f"{angle} degrees")

    def test_flat_arch(self):
        for method in SOLVERS:
            self.assert_stands(self.run_deck("flat_arch", solver__method=method))

    def test_row_of_tetrahedra(self):
        """Accelerated sweeps take four a step or, as rounding has it, the 5000 that are allowed, since forces from end to end have many
        ways: one step of 200 has been seen not to converge in a build with checks. The study allows 5 %; the row must stand all the same."""
        self.need_hulls()
        for method in SOLVERS:
            run = self.run_deck("tetrahedra_in_a_row", solver__method=method, time__steps=100)
            self.assert_stands(run, unconverged=0.05 if method == "accelerated" else 0)

    def test_plate_of_tetrahedra(self):
        """Of whole ones it stands without friction; where edges and corners are cut off it needs some, or sinks until corners meet."""
        self.need_hulls()
        for friction in (0, 1):
            self.assert_stands(self.run_deck("plate_of_tetrahedra", law__friction=friction))
        weight = 16 * 2500 * 7.29333e-4 * G
        for friction, sinks in ((0, True), (1, False)):
            run = self.run_deck("plate_of_cut_tetrahedra", law__friction=friction, time__steps=300)
            self.assertLess(run["max_velocity"], 1e-3)
            self.assert_near(run["floor_share"], 1, 1e-2)
            way = -run["potential_energy"] / weight
            if sinks:
                # Until the cut corners, 0.005 wide, meet: along slopes of 0.05/0.08 by 0.008 at the corners of the plate, by 2 and
                # 6 times that at its sides and in the middle.
                self.assert_near(way, 0.008 * (4 + 8 * 2 + 4 * 6) / 16, 1e-4)
            else:
                self.assert_near(way, 0, 1e-5)


class Broken(Stiff):
    def test_an_infinity_ends_the_run_within_its_step(self):
        """With the body and its contacts to blame, the state before it, and a contact problem that can be solved again."""
        if "ffpe-trap" in self.run_program("--version").stdout:
            self.skipTest("this build stops at the first overflow by itself")
        for method in ("nlgs", "auto"):
            run = self.run_deck("blown_away", code=4, solver__method=method)
            self.assertRegex(self.said, r"step 9: velocities without contacts, .* not finite of bodies 2; contacts .* 2-1 .* 2-4")
            self.assertEqual((run["status"], run["steps"]), ("failed", 8))
            if not self.has_hdf5():
                continue
            self.assertTrue((self.place / "out" / "restart_a.h5").exists())
            self.assertIn(" 4  auto", self.run_program("solve", "out/dump-9-local.hdf5").stdout)

    def test_a_balance_that_is_open(self):
        """With theta 1 the balance is open by the order of the step: nothing is said by default, code 6 where it is to stop."""
        run = self.run_deck("ball_on_floor", time__theta=1.0, body_1__position=[0.0, 0.5])
        self.assertNotIn("balance", self.said)
        run = self.run_deck("ball_on_floor", code=6, time__theta=1.0, body_1__position=[0.0, 0.5], guard__energy='"stop"')
        self.assertRegex(self.said, r"step 10: the energy balance is open by")
        self.assertEqual(run["steps"], 10)


if __name__ == "__main__":
    take_program()
    unittest.main(verbosity=1)
