"""The study of a network that moves through its subdomains, on a packing whose contacts are counted by hand."""

import h5py
import numpy as np
from moving_network import changed, rows
from sample_results import write_results
from splitgrain_postpro.results import Results


def test_interface_and_changes_of_two_rows_of_four_grains(tmp_path):
    """Columns 0, 1 and 2, 3 of a triangular packing: two contacts along the rows and one between them cross the cut. In the last
    picture grain 2, the second of the lower row, has gone over: it is grains 1, 5 and 6 that it touches across the cut."""
    folder = write_results(tmp_path / "moved", columns=4, rows=2, steps=3)
    with h5py.File(folder / "bodies.vtkhdf", "r+") as file:
        rank = file["VTKHDF/PointData/rank"]
        ranks = np.tile([0, 0, 1, 1, 0, 0, 1, 1, 0], (3, 1))
        ranks[2, 1] = 1
        rank[:] = ranks.ravel()
    found = list(rows(Results(folder)))
    # No picture holds contacts before the second. The lower cut loses 2-3 and gains 1-2, 2-5 and 2-6; 6-7 and 6-3 stay.
    assert [row[1:] for row in found] == [(4, 4, 0, 0, 0), (4, 4, 3, 13, 0), (3, 5, 5, 13, 1)]


def test_only_grains_that_both_pictures_have_can_change():
    """Grain 3 left and grain 4 entered; of 1 and 2 the second one is in another subdomain."""
    before, after = (np.array([1, 2, 3]), np.array([0, 0, 0])), (np.array([1, 2, 4]), np.array([0, 1, 1]))
    assert changed(before, after) == 1
    assert changed(before, before) == 0
