#!/usr/bin/env python3
"""The periodic cell, [cell], that moves as imposed: images, stress, energy, restarts, ranks, bad input.

usage: test_cells.py PROGRAM [MPIEXEC] [unittest options]
"""

import sys
import unittest
from math import cos, hypot, pi, sin
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from cell_case import AXES, LAW, ROUNDING, SOLVED, CellCase, grain, stretched
from program_case import take_program


class Cells(CellCase):
    def split(self, on_ranks):
        """Rows of the record of a run on two ranks, if there is a launcher, or else on three subdomains of one process."""
        where = {"ranks": 2} if on_ranks and self.launcher else {}
        self.call(*(() if where else ("--set", "partition.parts=3")), output="split", **where)
        return self.rows("split")

    def test_free_grains_move_with_the_cell(self):
        """Grains at rest in the cell follow the homogeneous motion; lengths and strains of the record do."""
        size, step, steps = (1.0, 0.8, 0.6), 1e-2, 150
        for dimension in (2, 3):
            for rates, shear in (((0.3, -0.2, 0.1), 0.0), ((0.0, 0.0, 0.0), 0.9), ((0.3, -0.2, 0.1), -0.5)):
                with self.subTest(dimension=dimension, rates=rates, shear=shear):
                    rates = rates[:dimension]
                    spots = {"a": (0.1, 0.7, 0.1), "b": (0.9, 0.05, 0.5), "c": (0.5, 0.4, 0.3)}
                    self.write(self.cell(size[:dimension], rates, shear),
                               "".join(grain(n, p[:dimension], 0.01) for n, p in spots.items()), dimension, step=step, steps=steps)
                    self.call()
                    move = stretched(rates, shear, step, steps)
                    last = self.places()[steps]
                    for name, place in spots.items():
                        for found, expected in zip(last[name][:dimension], move(place[:dimension]), strict=True):
                            self.assertAlmostEqual(found, expected, delta=ROUNDING)
                        self.assertEqual(last[name][dimension:], [0.0] * dimension)
                    row = self.rows()[-1]
                    for a in range(dimension):
                        unit = [size[b] if b == a else 0.0 for b in range(dimension)]
                        self.assertAlmostEqual(float(row[f"cell_{AXES[a]}"]), move(unit)[a], delta=ROUNDING)
                        # Midpoint steps of a logarithmic strain are exact to its third power.
                        self.assertAlmostEqual(float(row[f"strain_{2 * AXES[a]}"]), rates[a] * step * steps, delta=steps * step**3)
                    upper = move([0.0, size[1], 0.0][:dimension])
                    self.assertAlmostEqual(float(row["strain_xy"]), upper[0] / upper[1], delta=ROUNDING)

    def test_rates_of_time(self):
        """A rate that is an expression of time takes its value in the middle of a step."""
        self.write('[cell]\nsize = [1.0, 1.0]\nstrain_rate_yy = "0.4*t"\n', grain("a", (0.5, 0.5), 0.01), steps=500)
        self.call()
        self.assertAlmostEqual(float(self.rows()[-1]["strain_yy"]), 0.2 * 0.5**2, delta=1e-8)
        self.assertEqual(float(self.rows()[-1]["strain_xx"]), 0.0)

    def test_own_velocities(self):
        """Beyond the cell a free grain has a velocity V with V' = -G V, by Newton's law: the place is that of uniform motion in the
        world where the cell shears at a constant rate."""
        for dimension in (2, 3):
            velocity = (0.2, 0.3, 0.1)[:dimension]
            self.write(self.cell((1.0,) * dimension, (0.0,) * dimension, 0.7),
                       grain("a", (0.2, 0.3, 0.4)[:dimension], 0.01, velocity), dimension, step=1e-4, steps=2000)
            self.call()
            place = self.places()[2000]["a"]
            time = 0.2
            # Explicit in the own velocity: of first order in the step.
            self.assertAlmostEqual(place[0], 0.2 + (0.2 + 0.7 * 0.3) * time, delta=1e-5)
            self.assertAlmostEqual(place[1], 0.3 + 0.3 * time, delta=ROUNDING)
            self.assertAlmostEqual(place[dimension], 0.2 - 0.7 * 0.3 * time, delta=ROUNDING)
            self.assert_closed()

    def test_stages(self):
        """A stage may change the rates; strains count from the start."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints, from which stages go on")
        stages = "[[stage]]\nsteps = 50\n[[stage]]\nsteps = 100\n[stage.cell]\nstrain_rate_xx = -0.4\nshear_rate = 0.5\n"
        self.write(self.cell((1.0, 1.0), (0.2, 0.0)), grain("a", (0.5, 0.5), 0.01) + stages, steps=150)
        self.call()
        row = self.rows()[-1]
        self.assertAlmostEqual(float(row["strain_xx"]), 0.2 * 0.05 - 0.4 * 0.1, delta=1e-8)
        self.assertAlmostEqual(float(row["strain_xy"]), 0.05, delta=0.05**2)
        self.assertEqual(float(self.rows()[49]["strain_xy"]), 0.0)

    def test_shifted_grains(self):
        """Where the cell begins is arbitrary: grains that collide through a boundary, moved by any way and folded, do the same."""
        for dimension, shear in ((2, 0.0), (2, 1.5), (3, 0.0), (3, -1.0)):
            with self.subTest(dimension=dimension, shear=shear):
                cell = self.cell((1.0,) * dimension, (2.5, 2.0, 2.2)[:dimension], shear)
                moved = (0.37, 0.61, 0.23)[:dimension]
                spots = self.spots(dimension)
                results = []
                for output, way in (("out", (0.0,) * dimension), ("moved", moved)):
                    body = ""
                    for i, (place, velocity) in enumerate(spots):
                        # The cell is upright at the start.
                        body += grain(f"g{i}", [(x + w) % 1.0 for x, w in zip(place, way, strict=True)], 0.1, velocity)
                    self.write(cell, body, dimension, steps=80, law=LAW.format(friction=0.3) + "")
                    self.call(output=output)
                    results.append(self.places(output)[80])
                    self.assert_closed(output)
                for name, state in results[0].items():
                    for found, expected in zip(results[1][name][dimension:], state[dimension:], strict=True):
                        self.assertAlmostEqual(found, expected, delta=SOLVED)
                one, other = (self.rows(output)[-1] for output in ("out", "moved"))
                self.assertGreater(float(one["impact_loss"]), 0)
                self.assertEqual(one["contacts"], other["contacts"])
                for key in ("stress_xx", "stress_xy", "stress_yy", "kinetic_energy", "external_work", "friction_loss"):
                    self.assertAlmostEqual(float(one[key]), float(other[key]), delta=SOLVED * max(1.0, abs(float(one[key]))))

    def test_repeated_grains(self):
        """Two cells next to each other are one: stress and energy per volume, velocities of the copies."""
        for dimension, shear, axis in ((2, 0.0, 0), (2, 1.5, 1), (3, 0.0, 2)):
            with self.subTest(dimension=dimension, shear=shear):
                spots = self.spots(dimension)
                rates = (2.5, 2.0, 2.2)[:dimension]
                body = "".join(grain(f"g{i}", place, 0.1, velocity) for i, (place, velocity) in enumerate(spots))
                self.write(self.cell((1.0,) * dimension, rates, shear), body, dimension, steps=60)
                self.call()
                size = [1.0] * dimension
                size[axis] = 2.0
                for i, (place, velocity) in enumerate(spots):
                    place = list(place)
                    place[axis] += 1.0
                    body += grain(f"c{i}", place, 0.1, velocity)
                self.write(self.cell(size, rates, shear), body, dimension, steps=60)
                self.call(output="both")
                one, both = self.places()[60], self.places("both")[60]
                for i in range(len(spots)):
                    for copy in "gc":
                        for found, expected in zip(both[f"{copy}{i}"][dimension:], one[f"g{i}"][dimension:], strict=True):
                            self.assertAlmostEqual(found, expected, delta=SOLVED)
                one, both = self.rows()[-1], self.rows("both")[-1]
                for key, factor in (("stress_xx", 1), ("stress_yy", 1), ("stress_yx", 1), ("kinetic_energy", 2), ("external_work", 2)):
                    self.assertAlmostEqual(float(both[key]), factor * float(one[key]), delta=SOLVED * max(1.0, abs(float(both[key]))))
                self.assertEqual(int(both["contacts"]), 2 * int(one["contacts"]))

    def test_folded_tilt(self):
        """Where the tilt is folded back is arbitrary: two cells side by side, which fold at twice the strain, do what one does; so
        do ranks, parts and a restart after a fold. Strain and displacements go on; guesses of impulses are kept."""
        for dimension in (2, 3):
            with self.subTest(dimension=dimension):
                spots, rates, shear, steps = self.spots(dimension), (0.5, 1.8, 1.2)[:dimension], 9.0, 75
                text = {}
                for width in (1, 2):
                    body = "".join(grain(f"g{i}_{copy}", [place[0] + copy, *place[1:]], 0.1, velocity)
                                   for i, (place, velocity) in enumerate(spots) for copy in range(width))  # fmt: skip
                    text[width] = (self.cell((float(width), *(1.0,) * (dimension - 1)), rates, shear), body)
                    self.write(*text[width], dimension, steps=steps)
                    self.call(output=f"wide{width}")
                    self.assert_closed(f"wide{width}")
                one, two = self.rows("wide1"), self.rows("wide2")
                self.assertGreater(int(one[-1]["contacts"]), 8)
                # Of the one cell the tilt is folded, of the two not yet.
                strain = [float(row["strain_xy"]) for row in one]
                self.assertGreater(strain[-1], 0.6)
                self.assertLess(float(two[-1]["strain_xy"]) * float(two[-1]["cell_y"]), float(two[-1]["cell_x"]) / 2)
                for left, right in zip(one, two, strict=True):
                    self.assertEqual(2 * int(left["contacts"]), int(right["contacts"]), left["step"])
                    for key, factor in (("strain_xy", 1), ("stress_xx", 1), ("stress_yx", 1), ("kinetic_energy", 2), ("external_work", 2)):
                        self.assertAlmostEqual(float(right[key]), factor * float(left[key]), delta=SOLVED * max(1.0, abs(float(right[key]))),
                                               msg=f"step {left['step']} {key}")  # fmt: skip
                    # A guess that was lost takes a multiple of the sweeps.
                    self.assertLess(int(left["sweeps"]), 1.5 * int(right["sweeps"]) + 5, left["step"])
                self.assertGreater(float(one[-1]["impact_loss"]), 0)
                places, beside = self.places("wide1")[steps], self.places("wide2")[steps]
                for name, state in places.items():
                    for found, expected in zip(beside[name], state, strict=True):
                        self.assertAlmostEqual(found, expected, delta=SOLVED)
                self.write(*text[1], dimension, steps=steps)
                # Ranks in space, and in the plane subdomains of one process, whose numbers are those of ranks.
                for left, right in zip(one, self.split(dimension == 3), strict=True):
                    for key in ("strain_xy", "kinetic_energy", "stress_xx"):
                        self.assertAlmostEqual(float(left[key]), float(right[key]), delta=1e-6 * max(1.0, abs(float(left[key]))),
                                               msg=f"step {left['step']} {key}")  # fmt: skip
                if self.has_hdf5():
                    after = next(i for i, value in enumerate(strain) if value > 0.55) + 1
                    self.call("--set", f"time.steps={after}", output="again")
                    self.run_program("run", "deck.toml", "--output", "again", "--restart", "again")
                    self.assertEqual(one, self.rows("again"))

    def test_large_shear(self):
        """Free grains move with a cell that shears to a strain of 6, in both directions, whatever the folds."""
        step, steps = 1e-2, 250
        for dimension, shear in ((2, 3.0), (3, -3.0)):
            rates = (0.1, -0.1, 0.0)[:dimension]
            spots = {"a": (0.1, 0.7, 0.1), "b": (0.9, 0.05, 0.5)}
            self.write(self.cell((1.0, 0.8, 0.6)[:dimension], rates, shear),
                       "".join(grain(n, p[:dimension], 0.01) for n, p in spots.items()), dimension, step=step, steps=steps)
            self.call()
            move, last = stretched(rates, shear, step, steps), self.places()[steps]
            for name, place in spots.items():
                for found, expected in zip(last[name], move(place[:dimension]), strict=False):
                    self.assertAlmostEqual(found, expected, delta=10 * ROUNDING)
            upper, rows = move([0.0, 0.8, 0.0][:dimension]), self.rows()
            self.assertAlmostEqual(float(rows[-1]["strain_xy"]), upper[0] / upper[1], delta=10 * ROUNDING)
            self.assertGreater(abs(upper[0] / upper[1]), 5)
            strain = [0.0] + [float(row["strain_xy"]) for row in rows]
            self.assertLess(max(abs(b - a) for a, b in zip(strain, strain[1:])), 2 * abs(shear) * step)

    def test_structure(self):
        """Radial distribution and longest wave of a sheared cell are those of the lattice of its images, on one rank and on two."""
        if not self.has_library("FFTW"):
            self.skipTest("a build without FFTW has no structure factors")
        for shear, ranks in ((1.7, 1), (2.2, 2 if self.launcher else 1)):
            # Touching grains are not at the edge of a bin.
            body = "".join(grain(f"g{i}", place, 0.097, velocity) for i, (place, velocity) in enumerate(self.spots(2)))
            self.write(self.cell((1.0, 1.0), (0.0, 0.0), shear), body + "[report]\nstructure = true\n", steps=200)
            self.call("--set", "solver.tolerance=1e-6", "--set", "output.every=200", ranks=ranks)
            tilt = float(self.rows()[-1]["strain_xy"])
            places = [state[:2] for state in self.places()[200].values()]
            found = [row for row in self.rows(file="radial_distribution.csv") if int(row["step"]) == 200]
            width = float(found[1]["r_m"]) - float(found[0]["r_m"])
            counts = [0] * len(found)
            for x, y in places:
                for a, b in places:
                    rows = round(b - y)
                    across = a - x - rows * tilt
                    distance = hypot(across - round(across), b - y - rows)
                    if 0 < distance < width * len(found):
                        counts[int(distance / width)] += 1
            for i, (row, count) in enumerate(zip(found, counts, strict=True)):
                expected = count / (len(places) ** 2 * pi * width**2 * (2 * i + 1))
                self.assertAlmostEqual(float(row["g"]), expected, delta=1e-6 * max(1.0, expected))
            waves = [(hypot(m, n - m * tilt), m, n) for m in range(4) for n in range(-12, 12) if m > 0 or n > 0]
            length, m, n = min(waves)
            first = next(row for row in self.rows(file="structure_factor.csv") if int(row["step"]) == 200)
            self.assertAlmostEqual(float(first["k_per_m"]), 2 * pi * length, delta=1e-6)
            angles = [2 * pi * (m * x + (n - m * tilt) * y) for x, y in places]
            square = (sum(map(cos, angles)) ** 2 + sum(map(sin, angles)) ** 2) / len(places)
            self.assertAlmostEqual(float(first["s"]), square, delta=1e-3)

    def test_flow_curve(self):
        """Sheared under pressure at two inertia numbers, disks have the effective friction and the compactness of the linear laws of da
        Cruz and others (2005) to what a sample of this size scatters."""
        deck = Path(__file__).resolve().parents[2] / "input_decks/talk/flow_curve.toml"
        (self.place / "deck.toml").write_text(deck.read_text())
        pictures = ("--set", "output.every=0") + (() if self.has_hdf5() else ("--set", "restart.every=0"))
        for inertia, rate in ((0.1, 22), (0.3, 66)):
            self.call("--set", f"cell.shear_rate={rate}", "--set", 'stop.when="strain_xy > 3"', *pictures)
            rows = [row for row in self.rows() if float(row["strain_xy"]) > 1]
            shear, along_y, fill = (sum(float(row[key]) for row in rows) / len(rows)
                                    for key in ("mean_stress_xy", "mean_stress_yy", "compactness"))  # fmt: skip
            self.assertAlmostEqual(along_y / 1e4, 1.0, delta=0.05)
            self.assertAlmostEqual(-shear / along_y, 0.25 + 1.1 * inertia, delta=0.08)
            self.assertAlmostEqual(fill, 0.81 - 0.3 * inertia, delta=0.02)

    def test_stiffness(self):
        """Probed along either axis, a pack of elastic disks has a symmetric stiffness (to 1 %, what its tolerance leaves) and a bulk
        stiffness below that of affine motion, k z phi/(2 pi), but above half of it, as packs of more than four contacts per grain."""
        deck = Path(__file__).resolve().parents[2] / "input_decks/talk/stiffness.toml"
        (self.place / "deck.toml").write_text(deck.read_text().replace("[0.16, 0.24]", "[0.08, 0.12]")
                                              .replace("[0.0, 0.0, 0.16, 0.24]", "[0.0, 0.0, 0.08, 0.12]"))
        steps = ("--set", "stage[1].steps=4000", "--set", "stage[2].steps=200")
        begin = ("--set", "restart.every=0")
        if self.has_hdf5():
            self.call(*steps, "--set", "time.steps=4000", output="pressed")
            begin = ("--restart", "pressed")
        slopes = {}
        for axis, rates in (("xx", (1e-3, 0)), ("yy", (0, 1e-3))):
            settings = [word for key, rate in zip(("xx", "yy"), rates, strict=True)
                        for word in ("--set", f"stage[2].cell.strain_rate_{key}={rate}")]
            self.call(*begin, *steps, *settings, output=axis)
            rows = [row for row in self.rows(axis) if int(row["stage"]) == 2]
            self.assertEqual(len(rows), 20)
            first, last = rows[0], rows[-1]
            strain = float(last[f"strain_{axis}"]) - float(first[f"strain_{axis}"])
            for stress in ("xx", "yy"):
                slopes[stress + axis] = (float(last[f"stress_{stress}"]) - float(first[f"stress_{stress}"])) / strain
        self.assertAlmostEqual(slopes["xxyy"] / slopes["yyxx"], 1.0, delta=0.01)
        bulk = sum(slopes.values()) / 4
        affine = 1e6 * float(last["grain_coordination"]) * float(last["compactness"]) / (2 * pi)
        self.assertGreater(bulk, 0.5 * affine)
        self.assertLess(bulk, affine)
        self.assertGreater(float(last["grain_coordination"]), 4.0)

    def test_stress_of_a_lattice(self):
        """A square or cubic lattice of elastic grains at the distance a: the force k (2 R - a) of each contact gives the stress
        k (2 R - a)/a, in space k (2 R - a)/a^2. The gap is that which the law foresees, h a (strain rate) on from the middle of the
        step. The grains stay where the cell brings them."""
        radius, stiffness, step, rate = 0.05, 1e4, 1e-3, 0.02
        law = f'[[law]]\nname = "elastic"\nkind = "ELASTIC_REPELL_CLB"\nstiffness = {stiffness}\n'
        for dimension, n in ((2, 6), (3, 4)):
            with self.subTest(dimension=dimension):
                length = 2 * radius * n
                box = [0.0] * dimension + [length] * dimension
                sample = ('[[sample]]\nkind = "lattice"\n' + f"box = {box}\nradius = {radius}\nspacing = 1.0\n"
                          + ('shape = "sphere"\n' if dimension == 3 else "") + f'count = {n**dimension}\n')  # fmt: skip
                self.write(self.cell((length,) * dimension, (rate,) * dimension), sample, dimension, steps=50, law=law, step=step)
                self.call()
                before = length
                for row in self.rows():
                    now = float(row["cell_x"])
                    middle = (before + now) / 2 / n
                    before = now
                    # Each step foresees the gap at its end from that in its middle, over a whole step.
                    depth = 2 * radius - middle * (1 - step * rate)
                    for key in ("stress_xx", "stress_yy"):
                        self.assertAlmostEqual(float(row[key]), stiffness * depth / middle ** (dimension - 1), delta=1e-9 * stiffness)
                    self.assertAlmostEqual(float(row["stress_xy"]), 0.0, delta=1e-9 * stiffness)
                self.assertLess(float(self.rows()[-1]["kinetic_energy"]), 1e-20)
                self.assertGreater(float(self.rows()[-1]["external_work"]), 0)

    def test_axes_exchanged(self):
        """A scene and its mirror image, x for y and y for x, have stresses and velocities exchanged."""
        spots = self.spots(2)
        for output, turn in (("out", 1), ("turned", -1)):
            body = "".join(grain(f"g{i}", place[::turn], 0.1, velocity[::turn]) for i, (place, velocity) in enumerate(spots))
            self.write(self.cell((1.0, 1.0), (2.5, -0.5)[::turn]), body, steps=70)
            self.call(output=output)
            self.assert_closed(output)
        one, other = self.places()[70], self.places("turned")[70]
        for name in one:
            for found, expected in zip(other[name], [one[name][i] for i in (1, 0, 3, 2)], strict=True):
                self.assertAlmostEqual(found, expected, delta=SOLVED)
        one, other = self.rows()[-1], self.rows("turned")[-1]
        self.assertAlmostEqual(float(one["stress_xx"]), float(other["stress_yy"]), delta=SOLVED * abs(float(one["stress_xx"])) + SOLVED)

    def test_plane_in_space(self):
        """Spheres in one layer move as disks of the same mass and arms do where nothing rubs: places of both agree."""
        spots = self.spots(2)
        self.write(self.cell((1.0, 1.0), (2.5, 1.0), 0.4), "".join(grain(f"g{i}", p, 0.1, v) for i, (p, v) in enumerate(spots)), steps=60,
                   law=LAW.format(friction=0.0))
        self.call()
        self.write(self.cell((1.0, 1.0, 1.0), (2.5, 1.0, 0.0), 0.4),
                   "".join(grain(f"g{i}", [*p, 0.5], 0.1, [*v, 0.0]) for i, (p, v) in enumerate(spots)), 3, steps=60, law=LAW.format(friction=0.0))
        self.call(output="space")
        plane, space = self.places()[60], self.places("space")[60]
        for name, state in plane.items():
            for found, expected in zip([space[name][i] for i in (0, 1, 3, 4)], state, strict=True):
                self.assertAlmostEqual(found, expected, delta=SOLVED)

    def test_restart(self):
        """A run that goes on from a checkpoint is the one that never stopped, bit for bit; also with polygons and polyhedra."""
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        for dimension, shape in ((2, "disk"), (2, "polygon"), (3, "sphere"), (3, "polyhedron")):
            with self.subTest(shape=shape):
                self.write(self.cell((1.0,) * dimension, (1.5, 1.2, 1.8)[:dimension], 0.8), self.sample(dimension, shape), dimension,
                           steps=150)
                self.call("--set", "solver.tolerance=1e-6")
                self.call("--set", "solver.tolerance=1e-6", "--set", "time.steps=90", output="parts")
                self.run_program("run", "deck.toml", "--output", "parts", "--restart", "parts", "--set", "solver.tolerance=1e-6")
                self.assertEqual(self.rows(), self.rows("parts"))
                # Gyroscopic torques of polyhedra do some work in steps with impacts.
                if shape != "polyhedron":
                    self.assert_closed()
                self.assertGreater(float(self.rows()[-1]["impact_loss"]), 0)
        self.write("", self.sample(3, "polyhedron"), 3, steps=200)
        said = self.run_program("run", "deck.toml", "--output", "other", "--restart", "parts", code=2).stderr
        self.assertIn("periodic cell", said)

    def test_ranks(self):
        """On two ranks, or in parts of one process, whose numbers are those of ranks, the same motion to what the tolerance leaves;
        the balance closes. Polygons are on ranks in test_cell_stresses.py."""
        for dimension, shape, shear, on_ranks in ((2, "disk", 0.0, False), (2, "disk", 2.5, True), (2, "polygon", 1.0, False),
                                                  (3, "sphere", -1.0, True)):  # fmt: skip
            with self.subTest(shape=shape, shear=shear):
                self.write(self.cell((1.0,) * dimension, (1.5, 1.2, 1.8)[:dimension], shear), self.sample(dimension, shape), dimension,
                           steps=120, law=LAW.format(friction=0.0))
                self.call()
                one = self.rows()
                for left, right in zip(one, self.split(on_ranks), strict=True):
                    self.assertEqual(left["contacts"], right["contacts"])
                    for key in ("cell_x", "strain_yy", "strain_xy", "kinetic_energy", "external_work", "stress_xx", "stress_yy"):
                        self.assertAlmostEqual(float(left[key]), float(right[key]), delta=1e-6 * max(1.0, abs(float(left[key]))),
                                               msg=f"step {left['step']} {key}")  # fmt: skip
                self.assert_closed("split")
                self.assertGreater(float(one[-1]["impact_loss"]), 0)
                self.assertGreater(int(one[-1]["contacts"]), 10)

    def test_sample_fills_the_cell(self):
        """Grains at random lie across all faces of the cell, and none overlaps an image."""
        try:
            import h5py
        except ImportError:
            self.skipTest("no h5py")
        if not self.has_hdf5():
            self.skipTest("no HDF5")
        for dimension, shape in ((2, "disk"), (3, "sphere")):
            self.write(self.cell((1.0,) * dimension, (0.0,) * dimension), self.sample(dimension, shape), dimension, steps=1)
            self.call()
            # Its grains reach through the faces along each axis: some lie nearer to one than their least radius.
            with h5py.File(self.place / "out/restart_a.h5") as file:
                places = file["bodies/position"][:]
            near = 0.06 if dimension == 2 else 0.1
            for a in range(dimension):
                self.assertLess(min(min(p[a], 1 - p[a]) for p in places), near)
            self.assertEqual(float(self.rows()[-1]["volume_error"]), 0.0)
            self.assertNotIn("overlap", self.run_program("check", "deck.toml").stderr)

    def test_too_narrow(self):
        self.write(self.cell((0.3, 1.0), (5.0, 0.0)), grain("a", (0.1, 0.5), 0.1), steps=300)
        self.assertIn("the periodic cell is narrower than its widest grain", self.call(code=2).stderr)

    def test_bad_input(self):
        """One sentence each, at its place."""
        cell = self.cell((1.0, 1.0), (0.0, 0.0))
        wall = '[[wall]]\nname = "floor"\nfrom = [0.0, 0.1]\nto = [1.0, 0.1]\nthickness = 0.02\n'
        ball = grain("a", (0.5, 0.5), 0.01)
        for text, words in (
            ("[cell]\nshear_rate = 1.0\n" + ball, 'a periodic cell needs its "size"'),
            ("[cell]\nsize = [1.0, 0.0]\n" + ball, "the lengths of the cell must be above 0"),
            (cell + "strain_rate_zz = 1.0\n" + ball, "strain_rate_zz"),
            (cell + wall + ball, "a periodic cell holds free grains alone"),
            (cell + ball + "fixed = true\n", "a periodic cell holds free grains alone"),
            (cell + ball + '[[drive]]\nbody = "a"\ncomponent = "x"\n', "a periodic cell holds free grains alone"),
            (cell.replace("strain_rate_xx = 0.0", "strain_rate_xx = 1.0\nstress_xx = 1.0") + ball, 'give either "strain_rate_xx" or "stress_xx"'),
            ("[cell]\nstress_xx = 1.0\n" + ball, 'a periodic cell needs its "size"'),
            (cell.replace("0.0\n", '"1/t"\n') + ball, "has no value at t = 0.0 s"),
            (cell + grain("a", (1.5, 0.5), 0.01), "lies outside of the period"),
        ):  # fmt: skip
            with self.subTest(words=words):
                self.write(text, "")
                said = self.run_program("check", "deck.toml", code=2).stderr
                self.assertIn(words, said)
                self.assertRegex(said, r"deck.toml:\d+:\d+: error: ")
        for words, said in ((("solver.method=interior",), "imposed stress in a periodic cell needs the method nesterov or nlgs"),
                            (("partition.parts=2", "--set", "partition.gluing=enriched"),
                             "imposed stress in a periodic cell needs the gluing dual, primal or momentum")):  # fmt: skip
            self.write(self.pressed((1.0, 1.0), (1.0, 1.0)), ball)
            self.assertIn(said, self.run_program("run", "deck.toml", "--set", *words, code=2).stderr)
        for setting, words in (("scene.gravity=[0, -9.81]", "there is no gravity in a periodic cell"),
                               ("scene.period_x=1.0", "the periods are those of cell.size"),
                               ("time.substeps=2", "a periodic cell does not run in substeps")):  # fmt: skip
            self.write(cell, ball)
            self.assertIn(words, self.run_program("check", "deck.toml", "--set", setting, code=2).stderr)

    def test_density_of_the_deck(self):
        """Void ratio and compactness are those of the cell."""
        self.write(self.cell((1.0, 0.5), (0.0, 0.0)), grain("a", (0.5, 0.25), 0.1), steps=1)
        self.call()
        row = self.rows()[-1]
        self.assertAlmostEqual(float(row["void_ratio"]), 0.5 / (pi * 0.01) - 1, delta=ROUNDING * 100)
        self.assertAlmostEqual(float(row["compactness"]), pi * 0.01 / 0.5, delta=ROUNDING)


if __name__ == "__main__":
    take_program()
    unittest.main()
