"""Bands of runs, and what is held against them."""

import numpy as np
from spread import difference, held_against, left_out, newcomer, ranks


def test_a_curve_is_held_against_a_band():
    band = np.array([[0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 1.0, 1.0]])
    share, out = held_against(np.array([0.5, 1.0, 1.25, -0.75]), band)
    assert share == 0.5
    assert out == 0.75


def test_each_run_is_left_out_of_its_own_band():
    runs = np.array([[0.0, 0.0], [1.0, 1.0], [0.5, 3.0]])
    assert left_out(runs).tolist() == [[0.0, 1.0], [0.5, 0.5], [0.5, 2.0]]


def test_a_newcomer_meets_bands_as_narrow_as_the_runs_met():
    """Of runs of one kind, a newcomer does in the mean what each run does when left out, not better by a wider band."""
    random = np.random.default_rng(5)
    shares = np.array([[left_out(runs[1:])[:, 0].mean(), newcomer(runs[0], runs[1:])[0]]
                       for runs in random.normal(size=(300, 9, 40))])  # fmt: skip
    # In a band of m runs an equal one lies with a chance of (m - 1)/(m + 1); standard errors are 0.0012 and 0.0037.
    assert abs(shares.mean(0) - 6 / 8).max() < 0.015


def test_ranks_count_the_runs_below():
    assert ranks(np.array([0.5, 5.0]), np.array([[0.0, 0.0], [1.0, 1.0]])).tolist() == [1, 2]


def test_standard_error_of_a_difference():
    by, error = difference(np.array([3.0]), np.array([0.0, 2.0]))
    assert by == 2
    assert np.isclose(error, np.sqrt(2) * np.sqrt(1.5))
