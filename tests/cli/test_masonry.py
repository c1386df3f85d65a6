#!/usr/bin/env python3
"""Masonry with known answers: a block that rocks, walls, a flat arch and a dome against limit analysis."""

import csv
import importlib.util
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from limit_analysis import centre_and_area, largest, load_multiplier  # noqa: E402
from program_case import ProgramCase, take_program  # noqa: E402

DECKS = Path(__file__).resolve().parents[2] / "input_decks"
HALF_WIDTH, HALF_HEIGHT, SHARE = 0.1, 0.4, 0.4
SLENDERNESS = math.atan(HALF_WIDTH / HALF_HEIGHT)
"""Angle from the vertical of the way from a corner to the centre, at which the block falls [rad]"""


def release(tilt, step=1e-5):
    """Time from a tilt at rest to the impact, and the spin there, of a block that turns about its corner [Housner1963]."""
    square = 3 * 9.81 / (4 * math.hypot(HALF_WIDTH, HALF_HEIGHT))
    time, spin = 0.0, 0.0
    while tilt > 0:
        gained = step * square * math.sin(SLENDERNESS - tilt)
        tilt -= step * (spin + gained / 2)
        spin += gained
        time += step
    return time, spin


def brick_wall(rows, columns, length, height, gap):
    """Bricks of a wall in running bond, half bricks at the ends of every second row, and its bed joints, for limit analysis."""
    bricks = []
    for row in range(rows):
        n, begin = columns + row % 2, 0.0
        for column in range(n):
            end = begin + ((length - gap) / 2 if row % 2 and column in (0, n - 1) else length)
            bricks.append((row, begin, end))
            begin = end + gap
    joints = [(i, None, (begin, 0.0), (end, 0.0), (0.0, 1.0)) for i, (row, begin, end) in enumerate(bricks) if row == 0]
    for i, (row, begin, end) in enumerate(bricks):
        for k, (below, first, last) in enumerate(bricks):
            low, high = max(begin, first), min(end, last)
            if below == row - 1 and high > low + 1e-9:
                joints.append((i, k, (low, row * height), (high, row * height), (0.0, 1.0)))
    return [[(a, r * height), (b, r * height), (b, (r + 1) * height), (a, (r + 1) * height)] for r, a, b in bricks], joints


def volume_and_centre(corners):
    """Volume of a hexahedron (four corners below, four above), and its centre."""
    volume, moment = 0.0, [0.0, 0.0, 0.0]
    for a, b, c, d in ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)):
        for p, q, r in ((corners[a], corners[b], corners[c]), (corners[a], corners[c], corners[d])):
            part = sum(p[k] * (q[(k + 1) % 3] * r[(k + 2) % 3] - q[(k + 2) % 3] * r[(k + 1) % 3]) for k in range(3)) / 6
            volume += part
            moment = [m + part * (x + y + z) / 4 for m, x, y, z in zip(moment, p, q, r, strict=True)]
    return volume, [m / volume for m in moment]


def dome_stands(thickness, corner, rings, sectors, friction):
    """Is one sector of a dome in equilibrium under its weight, without tension in any joint? By symmetry forces between sectors push
    it outwards, at any corner of their joints; those between rings act at both edges of these."""
    half = math.pi / sectors

    def at(side, ring):
        """Distance from the axis and height of the middle of an edge; the first sector begins at the x axis."""
        x, y, z = corner(1 + side * thickness / 2, ring, 0)
        return math.hypot(x, y) * math.cos(half), z

    def solid(ring):
        places = [(side, r, s) for side in (-1, 1) for r, s in ((ring, 0), (ring, 1), (ring + 1, 1), (ring + 1, 0))]
        volume, (x, y, z) = volume_and_centre([corner(1 + side * thickness / 2, r, s) for side, r, s in places])
        return volume, math.hypot(x, y)

    n = 9 * rings
    equations, values = [[0.0] * n for _ in range(4 * rings)], [0.0] * (4 * rings)
    for k in range(rings):
        (x, z), (outer_x, outer_z) = at(-1, k), at(1, k)
        length = math.hypot(outer_x - x, outer_z - z)
        along = ((outer_x - x) / length, (outer_z - z) / length)
        normal = (-along[1], along[0])
        forces = (((x, z), normal), ((outer_x, outer_z), normal), ((x, z), along), ((x, z), (-along[0], -along[1])))
        for ring, sign in ((k, 1.0), (k - 1, -1.0)):
            for c, ((a, b), (f, g)) in enumerate(forces if ring >= 0 else ()):
                for row, part in enumerate((f, g, a * g - b * f)):
                    equations[3 * ring + row][5 * k + c] += sign * part
        equations[3 * rings + k][5 * k:5 * k + 5] = [friction, friction, -1.0, -1.0, -1.0]
        volume, distance = solid(k)
        values[3 * k + 1:3 * k + 3] = [volume, distance * volume]
        for c, (side, ring) in enumerate(((-1, k), (1, k), (-1, k + 1), (1, k + 1))):
            equations[3 * k][5 * rings + 4 * k + c] = 1.0
            equations[3 * k + 2][5 * rings + 4 * k + c] = -at(side, ring)[1]
    return largest([0.0] * n, equations, values) is not None


class Masonry(ProgramCase):
    def test_rocking_block(self):
        """Time to the first impact, spin there, and the share of the spin that each impact leaves: 1 - 3/2 sin2(slenderness)."""
        self.run_program("run", DECKS / "rocking_block.toml", "--output", "out", "--quiet", "--force")
        with (self.place / "out" / "tracks.csv").open(newline="") as file:
            motion = [(float(row["time"]), float(row["spin"])) for row in csv.DictReader(file)]
        peaks, direction = [(0.0, 0.0)], 1.0
        for time, spin in motion:
            if spin * direction < 0:
                direction = -direction
                peaks.append((time, 0.0))
            if abs(spin) > peaks[-1][1]:
                peaks[-1] = (time, abs(spin))
        time, spin = release(SHARE * SLENDERNESS)
        self.assertAlmostEqual(peaks[0][0] / time, 1.0, delta=0.01)
        self.assertAlmostEqual(peaks[0][1] / spin, 1.0, delta=0.005)
        left = 1 - 1.5 * math.sin(SLENDERNESS) ** 2
        self.assertGreaterEqual(len(peaks), 5)
        for before, after in zip(peaks[:4], peaks[1:5], strict=True):
            self.assertAlmostEqual(after[1] / before[1] / left, 1.0, delta=0.008)
        # Half periods shorten with the amplitude: from impact to impact the block rises and falls.
        share = SHARE
        for n in range(1, 4):
            # The energy that is left gives the next tilt: 1 - cos(slenderness - tilt) over that at rest.
            drop = (math.cos(SLENDERNESS * (1 - share)) - math.cos(SLENDERNESS)) * left**2
            share = 1 - math.acos(math.cos(SLENDERNESS) + drop) / SLENDERNESS
            half = 2 * release(share * SLENDERNESS)[0]
            self.assertAlmostEqual((peaks[n][0] - peaks[n - 1][0]) / half, 1.0, delta=0.02)


    def run_deck(self, name, *words, output="out", ranks=1):
        self.run_program("run", DECKS / "masonry" / name, "--output", output, "--quiet", "--force", *words, ranks=ranks)

    def test_pushed_wall(self):
        """The wall stands up to the multiplier of limit analysis; its speed then grows as the square of the time."""
        wanted = load_multiplier(*brick_wall(6, 2, 0.24, 0.12, 1e-3), 0.75)
        self.assertAlmostEqual(wanted, load_multiplier(*brick_wall(6, 2, 0.24, 0.12, 1e-3), 0.6), delta=1e-9)
        # What a standing wall moves by is what solves leave: up to 4e-4 m/s at an e8 of 1e-5, 1.4e-5 at 1e-6, 1.7e-6 at 1e-7.
        self.run_deck("pushed_wall.toml", "--set", "solver.tolerance=1e-6")
        rows = [(0.2 * float(row["time"]), float(row["max_velocity"])) for row in self.rows()]
        self.assertLess(max(speed for push, speed in rows if push < 0.98 * wanted), 1e-4)
        (a, slow), (b, fast) = [next(row for row in rows if row[1] > speed) for speed in (5e-3, 1.5e-2)]
        begin = a - (b - a) * math.sqrt(slow) / (math.sqrt(fast) - math.sqrt(slow))
        self.assertAlmostEqual(begin / wanted, 1.0, delta=0.005)

    def test_flat_arch(self):
        """As the abutment yields the thrust is the least one, with hinges below at the springers and above at the crown: half the weight
        times the way of its centre from the springer, over the rise."""
        self.run_deck("flat_arch.toml")
        # The joints meet 0.9 m below the soffit.
        (x, _), area = centre_and_area([(-0.5, 0.0), (0.0, 0.0), (0.0, 0.25), (-0.5 * 1.15 / 0.9, 0.25)])
        wanted = 2400 * 9.81 * area * (x + 0.5) / 0.25
        last = self.rows(file="interfaces.csv")
        last = [row for row in last if row["step"] == last[-1]["step"]]
        self.assertEqual(len(last), 7)
        for row in last:
            # The abutment has gone by 0.5 mm: the crown has sunk by as much over the rise, 0.2 % of it.
            self.assertAlmostEqual(abs(float(row["force_x"])) / wanted, 1.0, delta=4e-3)
        shares = {(row["first"], row["second"]): abs(2 * float(row["eccentricity"]) / float(row["area"])) for row in last}
        hinges = {pair for pair, share in shares.items() if share > 0.999}
        self.assertEqual(hinges, {("left", "voussoir.1"), ("right", "voussoir.6"), ("voussoir.3", "voussoir.4")})
        if not self.launcher:
            return
        # Two ranks find the same forces, to the tolerance of the solver (1e-6 of the largest).
        self.run_deck("flat_arch.toml", output="ranks", ranks=2)
        other = [row for row in self.rows("ranks", "interfaces.csv") if row["step"] == last[-1]["step"]]
        self.assertEqual([(row["first"], row["second"]) for row in other], list(shares))
        for ours, theirs in zip(other, last, strict=True):
            self.assertAlmostEqual(float(ours["force_x"]) / float(theirs["force_x"]), 1.0, delta=1e-5)

    def test_dome(self):
        """A dome stands where limit analysis lets it, and falls where it is thinner by a twentieth; what its ground carries is its
        weight, and its lowest rings are open between the sectors, as in a dome that its hoops do not tie."""
        specification = importlib.util.spec_from_file_location("make_dome", DECKS / "masonry" / "make_dome.py")
        maker = importlib.util.module_from_spec(specification)
        specification.loader.exec_module(maker)
        thin, thick = 0.02, 0.08
        for _ in range(10):
            middle = (thin + thick) / 2
            if dome_stands(middle, maker.corner, maker.RINGS, maker.SECTORS, 1.0):
                thick = middle
            else:
                thin = middle
        # Of shells whose rings are thin it is 0.042 [Heyman1967].
        self.assertAlmostEqual(thick, 0.0363, delta=2e-4)
        folder = self.place / "dome"
        folder.mkdir()
        (folder / "dome.toml").write_text((DECKS / "masonry" / "dome.toml").read_text())
        for share in (1.05, 0.95):
            for name, text in maker.files(share * thick).items():
                (folder / name).write_text(text)
            self.run_program("run", folder / "dome.toml", "--output", "out", "--quiet", "--force", "--set", "time.steps=100")
            speed = float(self.rows()[-1]["max_velocity"])
            if share < 1:
                self.assertGreater(speed, 0.05)
            else:
                self.assertLess(speed, 1e-4)
        self.run_deck("dome.toml")
        for name in ("dome_00.obj", "dome_01.obj", "dome_10.obj", "dome_11.obj"):
            self.assertEqual((DECKS / "masonry" / name).read_text(), maker.files()[name])
        self.check_dome(maker)

    def check_dome(self, maker):
        """Weight and hoop forces of the dome of the deck."""
        volume = 0.0
        for ring in range(maker.RINGS):
            places = [(side, r, s) for side in (-1, 1) for r, s in ((ring, 0), (ring, 1), (ring + 1, 1), (ring + 1, 0))]
            volume += maker.SECTORS * volume_and_centre([maker.corner(1 + side * 0.04, r, s) for side, r, s in places])[0]
        last = self.rows(file="interfaces.csv")
        last = [row for row in last if row["step"] == last[-1]["step"]]
        ground = sum(abs(float(row["force_z"])) for row in last if "ground" in (row["first"], row["second"]))
        # The largest residual of the solver is 1e-4 of its forces.
        self.assertAlmostEqual(ground / (2400 * 9.81 * volume), 1.0, delta=1e-4)
        hoops = {}
        for row in last:
            first, second = row["first"].split("."), row["second"].split(".")
            if first[0] == second[0] == "ring" and first[1] == second[1]:
                hoops[first[1]] = hoops.get(first[1], 0.0) + float(row["normal_force"]) / maker.SECTORS
        self.assertGreater(min(hoops["5"], hoops["6"]), 100.0)
        self.assertLess(max(hoops["2"], hoops["3"]), 0.05 * hoops["6"])

    def test_shaken_wall(self):
        """A wall of rigid bricks moves with a ground whose acceleration stays below the multiplier of limit analysis, 0.536 g: under the
        record of 0.5 g no brick is left behind, under that of 0.8 g they shift by centimetres."""
        for column, least, most in ((2, 0.0, 1e-5), (3, 0.01, 0.1)):
            self.run_deck("shaken_wall.toml", "--set", f"drive[1].column={column}")
            ways = {}
            for row in self.rows(file="tracks.csv"):
                ways.setdefault(row["body"], []).append(float(row["x"]))
            ground = ways.pop("ground")
            self.assertGreater(max(ground) - min(ground), 0.05)
            shift = max(abs(x - way[0] - (g - ground[0])) for way in ways.values() for x, g in zip(way, ground, strict=True))
            self.assertLess(shift, most)
            self.assertGreaterEqual(shift, least)


if __name__ == "__main__":
    take_program()
    unittest.main()
