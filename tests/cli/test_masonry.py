#!/usr/bin/env python3
"""Masonry with known answers: a block that rocks."""

import csv
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
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


if __name__ == "__main__":
    take_program()
    unittest.main()
