"""Fragments of many triangles at once: which pixels each covers, row by row, and which fragment of a pixel is the nearest.

Pixels have whole numbers as centres. All loops are those of numpy: a picture of 1000 polyhedra has some 10,000 triangles.
"""

from collections.abc import Iterator

import numpy as np

# Fragments that are handled at a time: arrays that stay in the cache.
AT_A_TIME = 400_000
# Side of the tiles in which the farthest depth is looked up before triangles are painted [pixel].
TILE = 16


def fans(offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of convex faces as three places in their list of corners each, and the face of each."""
    sizes = np.diff(offsets)
    count = np.maximum(sizes - 2, 0)
    face = np.repeat(np.arange(len(sizes)), count)
    turn = np.arange(len(face)) - np.repeat(np.cumsum(count) - count, count)
    first = np.asarray(offsets)[face]
    return np.column_stack([first, first + turn + 1, first + turn + 2]), face


def paint_triangles(depth: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Put triangles (pixel column, pixel row, depth of each corner) into a depth buffer; returns which one each pixel shows, or -1.

    Those in front come first, so that what they hide is left out by tiles of the buffer.
    """
    height, width = depth.shape
    owner = np.full(depth.shape, -1)
    nearest = corners[:, :, 2].max(axis=1)
    low, high = corners[:, :, :2].min(axis=1), corners[:, :, :2].max(axis=1)
    covers = (np.ceil(low) <= np.floor(high)).all(axis=1)
    inside = covers & (high >= 0).all(axis=1) & (low <= (width - 1, height - 1)).all(axis=1)
    order = np.flatnonzero(inside)[np.argsort(-nearest[inside], kind="stable")]
    area = np.cumsum(np.prod(high[order] - low[order] + 1, axis=1))
    for number in range(int(area[-1] // AT_A_TIME) + 1 if len(order) else 0):
        own = order[(area // AT_A_TIME).astype(int) == number]
        if number:
            own = own[_may_be_seen(depth, low[own], high[own], nearest[own])]
        for rows, columns, values, triangles in _fragments(corners[own], own, height, width):
            _keep_nearest(depth.reshape(-1), owner.reshape(-1), rows * width + columns, values, triangles)
    return owner


def _may_be_seen(depth, low, high, nearest):
    """Which triangles are not hidden as a whole: small ones by the four tiles at their corners, large ones always may be seen."""
    height, width = depth.shape
    padded = np.full((-(-height // TILE) * TILE, -(-width // TILE) * TILE), np.inf)
    padded[:height, :width] = depth
    farthest = padded.reshape(padded.shape[0] // TILE, TILE, -1, TILE).min(axis=(1, 3))
    ends = [np.clip(np.floor(end).astype(int), 0, (width - 1, height - 1)) // TILE for end in (low, high)]
    seen = np.zeros(len(low), dtype=bool)
    for columns in ends:
        for rows in ends:
            seen |= farthest[rows[:, 1], columns[:, 0]] < nearest
    return seen | (high - low > TILE).any(axis=1)


def _fragments(corners, numbers, height, width) -> Iterator:
    """Rows, columns and depths of the pixels in each triangle, and its number; those in front come last."""
    corners, numbers = corners[::-1], numbers[::-1]
    corners = np.take_along_axis(corners, np.argsort(corners[:, :, 1], axis=1)[:, :, None], axis=1)
    (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = (corners[:, k].T for k in range(3))
    first = np.maximum(np.ceil(y0), 0).astype(int)
    count = np.maximum(np.minimum(np.floor(y2), height - 1).astype(int) - first + 1, 0)
    of_row = np.repeat(np.arange(len(corners)), count)
    row = np.arange(len(of_row)) - np.repeat(np.cumsum(count) - count, count) + first[of_row]
    is_lower = row < y1[of_row]
    long_ = _between(x0, y0, x2, y2)
    short = [np.where(is_lower, a[of_row], b[of_row]) for a, b in zip(_between(x0, y0, x1, y1), _between(x1, y1, x2, y2), strict=True)]
    one = long_[0][of_row] + long_[1][of_row] * row
    other = short[0] + short[1] * row
    left = np.maximum(np.ceil(np.minimum(one, other)), 0).astype(int)
    right = np.minimum(np.floor(np.maximum(one, other)), width - 1).astype(int)
    length = np.maximum(right - left + 1, 0)
    # The plane of each triangle: depth = a + b column + c row.
    twice = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    twice = np.where(twice == 0, np.inf, twice)
    b = ((z1 - z0) * (y2 - y0) - (z2 - z0) * (y1 - y0)) / twice
    c = ((x1 - x0) * (z2 - z0) - (x2 - x0) * (z1 - z0)) / twice
    a = z0 - b * x0 - c * y0
    start = (a[of_row] + c[of_row] * row)
    of_pixel = np.repeat(np.arange(len(of_row)), length)
    column = np.arange(len(of_pixel)) - np.repeat(np.cumsum(length) - length - left, length)
    triangle = of_row[of_pixel]
    yield row[of_pixel], column, start[of_pixel] + b[triangle] * column, numbers[triangle]


def _between(xa, ya, xb, yb):
    """The line x = a + b y through two points; a level one is never asked away from its first point."""
    rise = np.where(yb > ya, yb - ya, np.inf)
    slope = (xb - xa) / rise
    return xa - slope * ya, slope


def _keep_nearest(depth, owner, pixels, values, triangles):
    """Write fragments that are nearer than what is there. Of several in one pixel the last is written: again until none is nearer."""
    while True:
        nearer = values > depth[pixels]
        if not nearer.any():
            return
        pixels, values, triangles = pixels[nearer], values[nearer], triangles[nearer]
        depth[pixels] = values
        owner[pixels] = triangles
