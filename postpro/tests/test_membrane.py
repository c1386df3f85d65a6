"""Studies of the biaxial test between membranes and between rigid walls, on numbers that are known."""

import numpy as np
import pytest
from membrane_splits import ratios, verdicts
from walls import wall_curves


def test_overlap_at_cuts_is_that_between_ranks():
    """Grains 0 to 5 in a row, cut between 2 and 3: grains 2 and 3 touch another subdomain, so contacts 1-2 and 3-4 count for neither."""
    frame = {"pair": np.array([[0, 1, 2, 3, 4], [1, 2, 3, 4, 5]]), "rank": np.array([0, 0, 0, 1, 1, 1]),
             "gap": np.array([-1e-6, -9e-6, -4e-6, -9e-6, -3e-6])}  # fmt: skip
    # The cut over the mean of the two others; gaps that are open are no overlap.
    assert ratios(frame) == pytest.approx([4e-6, 2e-6, 4e-6, 3e-6])
    frame["gap"][0] = 1e-3
    assert ratios(frame) == pytest.approx([4e-6, 1.5e-6, 4e-6, 3e-6])


def test_a_split_is_judged_by_the_runs_that_are_left_out():
    """Twelve curves at heights 0 to 11: one at 5 is inside of all but the band of itself; one at 30 is out by 19, more than the worst."""
    ones = [np.full(9, float(height)) for height in range(12)]
    rows = verdicts("compactness", ones, {4: [np.full(9, 5.5)], 16: [np.full(9, 30.0)]})
    assert [row["within the worst"] for row in rows] == ["", "", "yes", "NO"]
    assert rows[0]["largest distance out"] == "1.0e+00" and rows[0]["inside the band"] == "0 %"
    # The runs have the mean 5.5 and the deviation sqrt(13) by n - 1 = 11; a mean of one against twelve: sqrt(13 (1 + 1/12)) = 3.75.
    assert rows[2]["mean of the last third, difference"] == "+0.0e+00 ± 3.8e+00"
    assert rows[3]["mean of the last third, difference"] == "+2.4e+01 ± 3.8e+00"


def test_stress_and_compactness_between_walls():
    """A sample 0.3 m wide and 0.6 m high at the start: 6 kN on the upper wall are 20 kPa, twice the confining pressure."""
    tracks = {"top": {"stage": np.array([1, 2, 2]), "y": np.array([0.61, 0.61, 0.55]), "mean_force_y": np.array([3e3, 3e3, 6.6e3])},
              "right": {"x": np.array([0.31, 0.31, 0.34])}}
    strain, deviator, compactness = wall_curves(tracks, 0.144)
    assert strain == pytest.approx([0, np.log(0.6 / 0.54)])
    assert deviator == pytest.approx([0, 1])
    assert compactness == pytest.approx([0.8, 0.144 / (0.33 * 0.54)])
