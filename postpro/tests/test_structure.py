"""g(r) and S(k) of points that are known, against the sums that define them, and peaks of a spectrum."""

import numpy as np
import pytest

from splitgrain_postpro.spectra import peaks
from splitgrain_postpro.structure import Centres, radial_distribution, structure_factor


def centres(points, length, is_periodic, diameter=1.0):
    d = points.shape[1]
    return Centres(points, np.zeros(d), np.full(d, float(length)), np.full(d, is_periodic), diameter)


@pytest.mark.parametrize("dimension, n", [(2, 900), (3, 1500)])
@pytest.mark.parametrize("is_periodic", [True, False])
def test_radial_distribution_is_the_count_of_pairs(dimension, n, is_periodic):
    points = np.random.default_rng(1).uniform(0, 12, size=(n, dimension))
    r, g = radial_distribution(centres(points, 12, is_periodic, 0.5))
    reach, width = 2.5, 2.5 / 200
    between = points[:, None] - points[None]
    if is_periodic:
        between -= 12 * np.round(between / 12)
    inside = np.ones(n, bool) if is_periodic else ((points >= reach) & (points <= 12 - reach)).all(1)
    distance = np.linalg.norm(between, axis=2)[inside]
    counts = np.histogram(distance[distance > 0], np.linspace(0, reach, 201))[0]
    edges = np.linspace(0, reach, 201)
    shells = np.diff(np.pi * edges**2 if dimension == 2 else 4 / 3 * np.pi * edges**3)
    density = inside.sum() / (12 if is_periodic else 12 - 2 * reach) ** dimension
    assert r == pytest.approx(edges[:-1] + width / 2)
    assert g == pytest.approx(counts / (inside.sum() * density * shells))


def test_narrow_periodic_box_meets_no_grain_twice():
    points = np.stack([np.arange(4.0) + 0.5, np.zeros(4) + 0.5], axis=1)
    points = np.concatenate([points + [0, y] for y in range(4)])
    r, g = radial_distribution(centres(points, 4, True))
    # Reach is a third of the period, 4/3: the four neighbours at a pitch and no other.
    shells = np.pi * np.diff(np.linspace(0, 4 / 3, 201) ** 2)
    assert (g * shells).sum() == pytest.approx(4)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("tilt", [3.0, -5.0])
def test_tilted_cell_is_the_lattice_of_its_images(dimension, tilt):
    """Pairs over all images, and waves of the lattice of images: S of a point and of a shift of all points by any edge."""
    points = np.random.default_rng(4).uniform(0, 12, size=(300, dimension))
    tilted = Centres(points, np.zeros(dimension), np.full(dimension, 12.0), np.full(dimension, True), 0.5, tilt)
    r, g = radial_distribution(tilted)
    images = np.stack(np.meshgrid(*[[-1, 0, 1]] * dimension), -1).reshape(-1, dimension) @ tilted.edges
    distance = np.concatenate([np.linalg.norm(points[:, None] - points[None] - image, axis=2).ravel() for image in images])
    edges = np.linspace(0, 2.5, 201)
    counts = np.histogram(distance[distance > 0], edges)[0]
    shells = np.diff(np.pi * edges**2 if dimension == 2 else 4 / 3 * np.pi * edges**3)
    assert g == pytest.approx(counts / (300 * 300 / 12**dimension * shells))
    k, s, _ = structure_factor(tilted, waves_a_bin=8)
    # A picture of the same grains may hold other images of them.
    ways = np.random.default_rng(5).integers(-2, 3, size=points.shape) @ tilted.edges
    others = structure_factor(Centres(points + ways, tilted.low, tilted.high, tilted.is_periodic, 0.5, tilt), waves_a_bin=8)
    assert others[0] == pytest.approx(k) and others[1] == pytest.approx(s)


def test_lattice_sheared_by_a_length_is_the_lattice():
    x = np.stack(np.meshgrid(*[np.arange(12) + 0.5] * 2), -1).reshape(-1, 2)
    upright = centres(x, 12, True, 0.5)
    tilted = Centres(x, upright.low, upright.high, upright.is_periodic, 0.5, 4.0)
    assert radial_distribution(tilted)[1] == pytest.approx(radial_distribution(upright)[1])
    assert structure_factor(tilted)[0][0] == pytest.approx(np.hypot(2 * np.pi / 12, 2 * np.pi / 36), rel=0.1)


def test_structure_factor_of_a_shaken_lattice():
    random = np.random.default_rng(2)
    x = np.stack(np.meshgrid(*[np.arange(40) + 0.5] * 2), -1).reshape(-1, 2)
    x = (x + 0.1 * random.normal(size=x.shape)) % 40
    k, s, waves = structure_factor(centres(x, 40, True), waves_a_bin=200)
    low = k < 6
    expected = 1 - np.exp(-((0.1 * k[low]) ** 2))
    # The mean of n waves is spread by one over the root of n; five times that, and a twentieth for the width of a bin.
    assert (np.abs(s[low] / expected - 1) < 5 / np.sqrt(waves[low]) + 0.05).all()
    # The first waves of the lattice, two of those of their bin.
    assert k[s[k < 7].argmax()] == pytest.approx(2 * np.pi, abs=0.2) and s[k < 7].max() > 5


def test_structure_factor_is_the_sum_that_defines_it():
    x = np.random.default_rng(3).uniform(0, 6, size=(30, 2))
    k, s, waves = structure_factor(centres(x, 6, True), waves_a_bin=2000)
    first = [abs(np.exp(-2j * np.pi / 6 * x @ wave).sum()) ** 2 / 30 for wave in ((1, 0), (0, 1))]
    assert waves[0] == 2 and k[0] == pytest.approx(2 * np.pi / 6)
    assert s[0] == pytest.approx(np.mean(first))


def test_nothing_to_tell():
    for points in (np.empty((0, 2)), np.array([[1.0, 1.0]])):
        one = Centres(points, np.ones(2), np.ones(2), np.zeros(2, bool), 1.0)
        assert not len(radial_distribution(one)[0]) and not len(structure_factor(one)[0])


def test_peaks_stand_out():
    power = np.random.default_rng(4).uniform(0.5, 1.5, size=1000)
    power[[100, 200, 305]] = 1e4, 1e3, 1e2
    power[101] = 5e3
    assert peaks(power) == [100, 200, 305]
