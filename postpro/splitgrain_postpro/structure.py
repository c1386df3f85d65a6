"""Structure of a packing from the centres of its grains: radial distribution g(r) and structure factor S(k).

The same as the run writes with `[report] structure`, of any picture and by other means: S(k) is summed wave by wave as it
is defined, over some waves of each bin.
"""

from dataclasses import dataclass, field
from itertools import product

import numpy as np

from .lattice import fold_bodies
from .vtkhdf import Grid

#: Bins of g, and their reach in diameters; how much of a period and of a box with ends they may take.
BINS, DIAMETERS, OF_PERIOD, OF_WIDTH = 200, 5.0, 1 / 3, 1 / 4
#: Bins of S and the largest k times the diameter.
MOST_BINS, MOST_K = 128, 8 * np.pi
#: References whose pairs are looked for at a time, and reals of a table of phases.
REFERENCES, PHASES = 2000, 4_000_000


@dataclass
class Centres:
    """Centres of grains [m], shape (grains, dimension), their box, and the mean diameter; in a periodic cell the way by which its
    upper y face is moved along x [m]."""

    points: np.ndarray
    low: np.ndarray
    high: np.ndarray
    is_periodic: np.ndarray
    diameter: float
    tilt: float = field(default=0.0)

    @property
    def dimension(self) -> int:
        return self.points.shape[1]

    @property
    def length(self) -> np.ndarray:
        return self.high - self.low

    @property
    def edges(self) -> np.ndarray:
        """Edges of the box as rows [m]."""
        edges = np.diag(self.length)
        edges[1, 0] = self.tilt
        return edges

    @property
    def stretch(self) -> float:
        """How much longer distances become at most where points are sheared back by the tilt."""
        slope = abs(self.tilt) / (self.length[1] or 1.0)
        return slope / 2 + np.sqrt(1 + slope**2 / 4)

    @property
    def upright(self) -> np.ndarray:
        """Points sheared back by the tilt."""
        points = self.points.copy()
        points[:, 0] -= self.tilt * (points[:, 1] - self.low[1]) / (self.length[1] or 1.0)
        return points


def centres_of(
    bodies: Grid, periods: tuple[float, float], diameter: float, is_in_space: bool, cell: np.ndarray | None = None
) -> Centres:
    """Centres of the grains of a picture; the box is the periodic cell (edges as rows) or the period where there is one, and ends
    with the grains otherwise."""
    dimension = 3 if is_in_space else 2
    points = np.array(bodies.points[np.asarray(bodies.point_data["is_grain"], bool), :dimension], dtype=float)
    if cell is not None:
        points += fold_bodies(points, cell)
        return Centres(points, np.zeros(dimension), np.diag(cell), np.full(dimension, True), diameter, float(cell[1, 0]))
    period = np.array([*periods, 0.0])[:dimension]
    if not is_in_space:
        period[1] = 0.0
    is_periodic = period > 0
    points[:, is_periodic] %= period[is_periodic]
    low, high = (points.min(0), points.max(0)) if len(points) else (np.zeros(dimension), np.zeros(dimension))
    return Centres(points, np.where(is_periodic, 0.0, low), np.where(is_periodic, period, high), is_periodic, diameter)


def radial_distribution(centres: Centres) -> tuple[np.ndarray, np.ndarray]:
    """Distances [m] and g there, over the grains whose surroundings lie in the box whole; empty when there is none."""
    d, length = centres.dimension, centres.length
    reach = min(DIAMETERS * centres.diameter, np.min(length * np.where(centres.is_periodic, OF_PERIOD, OF_WIDTH)) / centres.stretch)
    inside = (centres.points >= centres.low + reach) & (centres.points <= centres.high - reach)
    references = np.flatnonzero((inside | centres.is_periodic).all(1))
    if reach <= 0 or not len(references):
        return np.empty(0), np.empty(0)
    edges = np.linspace(0.0, reach, BINS + 1)
    counts = np.zeros(BINS)
    for first, second in _near_pairs(centres, references, reach):
        between = centres.points[second] - centres.points[first]
        if centres.tilt:
            between[:, 0] -= centres.tilt * np.round(between[:, 1] / length[1])
        between -= np.where(centres.is_periodic, length * np.round(between / length), 0.0)
        counts += np.histogram(np.linalg.norm(between, axis=1), edges)[0]
    density = len(references) / np.prod(length - np.where(centres.is_periodic, 0.0, 2 * reach))
    shells = np.diff(np.pi * edges**2 if d == 2 else 4 / 3 * np.pi * edges**3)
    return (edges[1:] + edges[:-1]) / 2, counts / (len(references) * density * shells)


def _near_pairs(centres, references, reach):
    """Pairs of a reference and another grain in its cell or one next to it, some references at a time."""
    reach *= centres.stretch
    columns = np.maximum(1, np.floor(centres.length / reach)).astype(int)
    places = centres.upright - centres.low
    places -= np.where(centres.is_periodic, centres.length * np.floor(places / centres.length), 0.0)
    cells = np.clip((places / centres.length * columns).astype(int), 0, columns - 1)
    key = np.ravel_multi_index(cells.T, columns)
    order = np.argsort(key, kind="stable")
    starts = np.searchsorted(key[order], np.arange(np.prod(columns) + 1))
    # Along an axis of fewer than three cells a step may lead to the same cell twice.
    steps = [range(-1, 2) if n > 2 else range(n) for n in columns]
    for chunk in np.array_split(references, len(references) // REFERENCES + 1):
        for step in product(*steps):
            there = cells[chunk] + step
            is_there = ((there >= 0) & (there < columns) | centres.is_periodic | (columns <= 2)).all(1)
            there = np.ravel_multi_index((there[is_there] % columns).T, columns)
            first = np.repeat(chunk[is_there], starts[there + 1] - starts[there])
            counts = starts[there + 1] - starts[there]
            ends = np.cumsum(counts)
            within = np.arange(len(first)) - np.repeat(ends - counts, counts)
            second = order[np.repeat(starts[there], counts) + within]
            is_pair = first != second
            yield first[is_pair], second[is_pair]


def structure_factor(
    centres: Centres, waves_a_bin: int = 64, seed: int = 1
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean k [1/m], mean S and number of waves of each bin: at most so many waves, taken at random."""
    d, length = centres.dimension, centres.length
    if not len(centres.points) or not (length > 0).all():
        return np.empty(0), np.empty(0), np.empty(0)
    most = MOST_K / centres.diameter
    width = max(2 * np.pi / length.max(), most / MOST_BINS)
    window = np.prod([np.ones(len(centres.points)) if periodic else (1 - np.cos(2 * np.pi * (x - low) / side)) / 2
                      for x, low, side, periodic in zip(centres.points.T, centres.low, length, centres.is_periodic)], axis=0)
    waves = _waves(centres, most, width, waves_a_bin, np.random.default_rng(seed))
    inverse = np.linalg.inv(centres.edges)
    k = np.linalg.norm(2 * np.pi * waves @ inverse.T, axis=1)
    s = np.empty(len(waves))
    for rows in np.array_split(np.arange(len(waves)), len(waves) * len(window) // PHASES + 1):
        phases = 2 * np.pi * waves[rows] @ (centres.points @ inverse).T
        s[rows] = ((np.cos(phases) @ window) ** 2 + (np.sin(phases) @ window) ** 2) / (window**2).sum()
    bins = np.ceil(k / width * (1 - 1e-12)).astype(int)
    numbers = np.bincount(bins)
    kept = numbers > 0
    return (np.bincount(bins, k)[kept] / numbers[kept], np.bincount(bins, s)[kept] / numbers[kept], numbers[kept])


def _waves(centres, most, width, waves_a_bin, random):
    """Whole numbers of waves along the sides of the box, some of each bin; where all waves of a bin are few, all of them."""
    d, edges = centres.dimension, centres.edges / (2 * np.pi)
    inverse = np.linalg.inv(edges)
    chosen = []
    for edge in np.arange(width, most * (1 + 1e-9), width):
        if edge <= 12 * width:
            # The whole shell is looked at: these are few waves.
            ranges = [np.arange(-int(edge * n) - 1, int(edge * n) + 2) for n in np.linalg.norm(edges, axis=1)]
            waves = np.stack(np.meshgrid(*ranges, indexing="ij"), -1).reshape(-1, d)
        else:
            directions = random.normal(size=(8 * waves_a_bin, d))
            radii = random.uniform(edge - width, edge, size=(len(directions), 1))
            waves = np.unique(np.rint(directions / np.linalg.norm(directions, axis=1)[:, None] * radii @ edges.T), axis=0)
        k = np.linalg.norm(waves @ inverse.T, axis=1) * (1 - 1e-12)
        waves = waves[(k > edge - width) & (k <= edge)]
        # Waves next to zero see the box; of a wave and its opposite one counts.
        waves = waves[(np.abs(waves) > np.where(centres.is_periodic, 0, 1)).any(1)]
        leading = np.take_along_axis(waves, (waves != 0).argmax(1)[:, None], 1)[:, 0] if len(waves) else np.empty(0)
        waves = waves[leading > 0]
        if len(waves) > waves_a_bin:
            waves = waves[np.sort(random.choice(len(waves), waves_a_bin, replace=False))]
        chosen.append(waves)
    return np.concatenate(chosen) if chosen else np.empty((0, d))
