#!/usr/bin/env python3
"""The periodic cell, [cell], under imposed stress: rates, energy, sweeps with momentum, ranks and restarts.

usage: test_cell_stresses.py PROGRAM [MPIEXEC] [unittest options]
"""

import json
import sys
import unittest
from math import pi
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from cell_case import AXES, LAW, ROUNDING, SOLVED, CellCase, grain
from program_case import take_program


class CellStresses(CellCase):
    def test_empty_cell_under_stress(self):
        """Without contacts the rate grows by volume times stress over the inertia, 2 m (2 R)^2 of the one grain, per step: recurrence
        of the midpoint rule."""
        radius, step, stress = 0.05, 5e-4, (40.0, 30.0, 20.0)
        for dimension, mass in ((2, 1000 * pi * radius**2), (3, 1000 * 4 / 3 * pi * radius**3)):
            with self.subTest(dimension=dimension):
                self.write(self.pressed((1.0,) * dimension, stress[:dimension], 10.0),
                           grain("a", (0.5,) * dimension, radius), dimension, steps=80, step=step)  # fmt: skip
                self.call()
                length, tilt, rate, shear = [1.0] * dimension, 0.0, [0.0] * dimension, 0.0
                inertia = 2 * mass * (2 * radius) ** 2
                for row in self.rows():
                    middle = [x / (1 - step * g / 2) for x, g in zip(length, rate, strict=True)]
                    middle_tilt = (tilt + step / 2 * shear * middle[1]) / (1 - step * rate[0] / 2)
                    volume = 1.0
                    for x in middle:
                        volume *= x
                    after = [g - step * volume * p / inertia for g, p in zip(rate, stress)]
                    shear_after = shear + step * volume * 10.0 / inertia
                    mean = [(g + f) / 2 for g, f in zip(rate, after, strict=True)]
                    tilt += step * (mean[0] * middle_tilt + (shear + shear_after) / 2 * middle[1])
                    length = [x + step * g * m for x, g, m in zip(length, mean, middle, strict=True)]
                    rate, shear = after, shear_after
                    for a in range(dimension):
                        self.assertAlmostEqual(float(row[f"cell_{AXES[a]}"]), length[a], delta=ROUNDING)
                    self.assertAlmostEqual(float(row["strain_xy"]), tilt / length[1], delta=ROUNDING)

    def test_lattice_under_stress(self):
        """A lattice of rigid grains with gaps closes along each axis in its turn, and carries the imposed stresses then: forces of its
        contacts balance, and nothing moves. In the plane and in space, with the axes exchanged, from disks and polygons."""
        radius = 0.05
        for dimension, n, shape in ((2, 5, "disk"), (3, 3, "sphere")):
            for turn in (1, -1):
                with self.subTest(shape=shape, turn=turn):
                    stress = (1e4, 2e4, 3e4)[:dimension][::turn]
                    length = 2 * radius * n
                    size = [length + 0.01 * (i + 1) for i in range(dimension)][::turn]
                    sample = (f'[[sample]]\nkind = "lattice"\nshape = "{shape}"\nbox = {[0.0] * dimension + [length] * dimension}\n'
                              f"radius = {radius}\nspacing = 1.0\ncount = {n**dimension}\n")  # fmt: skip
                    self.write(self.pressed(size, stress), sample, dimension, steps=100, law=LAW.format(friction=0.0))
                    self.call()
                    last = self.rows()[-1]
                    for a in range(dimension):
                        self.assertAlmostEqual(float(last[f"stress_{2 * AXES[a]}"]) / stress[a], 1.0, delta=SOLVED)
                        self.assertAlmostEqual(float(last[f"cell_{AXES[a]}"]), length, delta=1e-6 * length)
                    self.assertLess(float(last["kinetic_energy"]), 1e-15)
                    self.assert_closed()

    def test_pack_under_stress(self):
        """Grains at random carry the imposed stresses when they rest; two cells next to each other are one; a restart is bit for bit; the
        balance closes; a rate may be imposed along one axis and a stress along the other."""
        words = ("--set", "solver.tolerance=1e-6", "--set", "solver.method=nesterov")
        self.write(self.pressed((1.0, 1.0), (1e4, 1.5e4)), self.sample(2, "disk"), steps=600, step=1e-3)
        self.call(*words)
        last = self.rows()[-1]
        # The rates that are left, over the weight of the cell, are those of a pack that creeps to rest.
        for key, stress in (("stress_xx", 1e4), ("stress_yy", 1.5e4)):
            self.assertAlmostEqual(float(last[key]) / stress, 1.0, delta=1e-2)
        self.assert_closed()
        if self.has_hdf5():
            self.call(*words, "--set", "time.steps=150", output="parts")
            self.run_program("run", "deck.toml", "--output", "parts", "--restart", "parts", *words)
            self.assertEqual(self.rows(), self.rows("parts"))
        cell = "[cell]\nsize = [1.0, 1.0]\nstress_xx = 1e4\nstrain_rate_yy = 0.5\n"
        self.write(cell, self.sample(2, "disk"), steps=1000, step=1e-3)
        self.call(*words)
        rows = self.rows()
        self.assertAlmostEqual(float(rows[-1]["strain_yy"]), 0.5, delta=1e-6)
        mean = sum(float(row["stress_xx"]) for row in rows[500:]) / len(rows[500:])
        self.assertAlmostEqual(mean / 1e4, 1.0, delta=0.05)
        self.assert_closed()

    def test_momentum_under_stress(self):
        """Sweeps with momentum find what plain ones do, in all layouts of the sweep, and are fewer."""
        # Polygons and polyhedra that lie face to face take plain sweeps beyond their limit: only as far as the first of these.
        for dimension, shape, steps in ((2, "disk", 120), (2, "polygon", 55), (3, "sphere", 120), (3, "polyhedron", 60)):
            if shape == "polyhedron" and not self.has_library("Qhull"):
                continue
            for order in ("groups", "natural"):
                with self.subTest(shape=shape, order=order):
                    self.write_pressed_sample(dimension, shape, steps)
                    self.call("--set", f"solver.order={order}")
                    self.call("--set", f"solver.order={order}", "--set", "solver.method=nesterov", output="momentum")
                    plain = self.rows()
                    self.assert_same_motion(plain, "momentum", shape)
                    self.assertGreater(float(plain[-1]["impact_loss"]), 0)
                    if steps == 120:
                        fewer, more = (sum(int(row["sweeps"]) for row in self.rows(output)) for output in ("momentum", "out"))
                        self.assertLess(fewer, 0.9 * more)

    def test_ranks_under_stress(self):
        """On two ranks, and in parts of one process, the same motion, also after a restart."""
        for dimension, shape, steps in ((2, "disk", 70), (2, "polygon", 55), (3, "sphere", 70)):
            with self.subTest(shape=shape):
                self.write_pressed_sample(dimension, shape, steps)
                momentum = ("--set", "solver.method=nesterov")
                self.call(*momentum)
                one = self.rows()
                for words in (("gluing=dual",), ("gluing=primal",), ("gluing=momentum",), ("sweeps=[3]",), ("gluing=primal", "primal.interface_sweeps=3")):
                    own = [word for value in words for word in ("--set", "partition." + value)]
                    output = "straight" if words == ("gluing=dual",) else "parts"
                    self.call(*momentum, "--set", "partition.parts=3", *own, output=output)
                    self.assert_same_motion(one, output, shape)
                if self.launcher:
                    self.call(*momentum, output="ranks", ranks=2)
                    self.assert_same_motion(one, "ranks", shape)
                self.assertGreater(float(one[-1]["impact_loss"]), 0)
                self.assertGreater(int(one[-1]["contacts"]), 30)
                if self.has_hdf5():
                    # The split of a restart is another one: sums over ranks differ by rounding, and so does the first step.
                    parts = ("--set", "partition.parts=3", "--set", "partition.gluing=dual", *momentum)
                    self.call(*parts, "--set", f"time.steps={steps - 20}", output="parts")
                    self.run_program("run", "deck.toml", "--output", "parts", "--restart", "parts", *parts)
                    self.assert_same_motion(one, "parts", shape)
                    left, right = self.rows("straight")[steps - 20], self.rows("parts")[steps - 20]
                    for key in ("cell_x", "cell_y", "strain_xy", "kinetic_energy", "stress_xx", "stress_yy"):
                        self.assertAlmostEqual(float(left[key]), float(right[key]), delta=1e-9 * max(1.0, abs(float(left[key]))), msg=key)

    def test_pushes_under_stress(self):
        """Bodies of a cell that are pushed apart move alike in parts and on ranks, to what sweeps of a push leave of the overlap, 3e-4 of
        a radius."""
        self.write_pressed_sample(2, "polygon", 55, recovery=3e-4)
        often = ["--set", "time.recovery_every=4"]
        self.call(*often)
        one = self.rows()
        self.call(*often, "--set", "partition.parts=3", output="parts")
        outputs = ["parts"]
        if self.launcher:
            self.call(*often, output="ranks", ranks=2)
            outputs.append("ranks")
        for output in outputs:
            self.assertGreater(json.loads((self.place / output / "run.json").read_text())["recoveries"], 1)
            # Measured: 4e-6.
            self.assert_same_motion(one, output, "polygon", 1e-4)

    def test_repeated_grains_under_stress(self):
        spots = self.spots(2)
        body = "".join(grain(f"g{i}", place, 0.1, velocity) for i, (place, velocity) in enumerate(spots))
        self.write(self.pressed((1.0, 1.0), (6e3, 5e3), 500.0), body, steps=60)
        self.call()
        body += "".join(grain(f"c{i}", [place[0], place[1] + 1.0], 0.1, velocity) for i, (place, velocity) in enumerate(spots))
        self.write(self.pressed((1.0, 2.0), (6e3, 5e3), 500.0), body, steps=60)
        self.call(output="both")
        one, both = self.rows()[-1], self.rows("both")[-1]
        self.assertGreater(float(one["impact_loss"]), 0)
        for key, factor in (("cell_x", 1), ("cell_y", 2), ("strain_xy", 1), ("stress_xx", 1), ("stress_yy", 1), ("kinetic_energy", 2)):
            self.assertAlmostEqual(float(both[key]), factor * float(one[key]), delta=1e-6 * max(1.0, abs(float(both[key]))), msg=key)


if __name__ == "__main__":
    take_program()
    unittest.main()
