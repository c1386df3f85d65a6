"""A picture of solid shapes by a depth buffer, without a display or a graphics card.

Shapes are given in the axes of the camera: u to the right, v up, w towards the viewer [m]; parallel projection. Each
pixel keeps the nearest point: how near, of which item, which way its surface faces. Light and edges come last.
"""

from collections.abc import Collection, Iterable, Sequence

import numpy as np

from .fragments import fans, paint_triangles

NOTHING = -1
# Where the light comes from, in the axes of the camera.
LIGHT = np.array([-0.35, 0.55, 0.75])


class Canvas:
    """Pixels over a rectangle of the camera's plane, each twice divided so that edges come out smooth."""

    FINE = 2

    def __init__(self, box: Sequence[float] | np.ndarray, pixels: int):
        """box: (u low, u high, v low, v high) [m]; pixels: of the longer side."""
        self.box = box
        self.scale = self.FINE * pixels / max(box[1] - box[0], box[3] - box[2])
        self.width = self.FINE * max(1, round((box[1] - box[0]) * self.scale / self.FINE))
        self.height = self.FINE * max(1, round((box[3] - box[2]) * self.scale / self.FINE))
        self.u = box[0] + (np.arange(self.width) + 0.5) / self.scale
        self.v = box[2] + (np.arange(self.height) + 0.5) / self.scale
        self.depth = np.full((self.height, self.width), -np.inf)
        self.item = np.full((self.height, self.width), NOTHING, dtype=np.int64)
        self.piece = np.full((self.height, self.width), NOTHING, dtype=np.int64)
        self.normal = np.zeros((self.height, self.width, 3), dtype=np.float32)
        self.pieces = 0

    def _window(self, low, high):
        """Rows and columns of the pixels whose centres lie in a rectangle (u, v)."""
        left, bottom = np.ceil((np.asarray(low)[:2] - (self.box[0], self.box[2])) * self.scale - 0.5).astype(int)
        right, top = np.floor((np.asarray(high)[:2] - (self.box[0], self.box[2])) * self.scale - 0.5).astype(int) + 1
        return (slice(max(0, bottom), max(0, min(self.height, top))), slice(max(0, left), max(0, min(self.width, right))))

    def _paint(self, window, depth, normal, item):
        """Keep what is nearer than what is there; depth is -inf where there is nothing."""
        nearer = depth > self.depth[window]
        if not nearer.any():
            return
        self.depth[window][nearer] = depth[nearer]
        self.item[window][nearer] = item
        self.piece[window][nearer] = self.pieces
        self.normal[window][nearer] = normal if np.ndim(normal) == 1 else normal[nearer]

    def add_spheres(self, centres: np.ndarray, radii: np.ndarray, items: np.ndarray) -> None:
        """Spheres; items are the numbers by which they are coloured."""
        for centre, radius, item in zip(centres, radii, items, strict=True):
            self.pieces += 1
            self._sphere(centre, radius, item)

    def _sphere(self, centre, radius, item):
        window = self._window(centre - radius, centre + radius)
        u = (self.u[window[1]][None, :] - centre[0]) / radius
        v = (self.v[window[0]][:, None] - centre[1]) / radius
        w = 1 - u**2 - v**2
        inside = w > 0
        if inside.any():
            w = np.sqrt(np.where(inside, w, 0))
            normal = np.stack(np.broadcast_arrays(u, v, w), axis=-1)
            self._paint(window, np.where(inside, centre[2] + radius * w, -np.inf), normal, item)

    def add_polygons(self, polygons: Sequence[np.ndarray], items: np.ndarray, smooth: Collection[int] = ()) -> None:
        """Plane convex polygons, corners counter-clockwise seen from outside; seen from inside they are left out.

        smooth: of each polygon, whether it goes on into the one before it without an edge.
        """
        for k, (corners, item) in enumerate(zip(polygons, items, strict=True)):
            self.pieces += 0 if k < len(smooth) and smooth[k] else 1
            found = self._polygon(corners)
            if found is not None:
                self._paint(*found, item)

    def add_faces(self, points: np.ndarray, connectivity: np.ndarray, offsets: np.ndarray, items: np.ndarray) -> None:
        """Plane convex faces as `add_polygons` paints them, many at once: corners of face k are points[connectivity[offsets[k]:...]]."""
        triangles, face = fans(offsets)
        if not len(face):
            return
        corners = points[connectivity[triangles]]
        areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = np.column_stack([np.bincount(face, areas[:, k], len(offsets) - 1) for k in range(3)])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
        seen = np.flatnonzero(normals[face, 2] > 1e-6)
        corners = corners[seen]
        corners[:, :, :2] = (corners[:, :, :2] - (self.box[0], self.box[2])) * self.scale - 0.5
        owner = paint_triangles(self.depth, corners)
        painted = owner != NOTHING
        face = face[seen][owner[painted]]
        self.item[painted] = np.asarray(items)[face]
        self.piece[painted] = self.pieces + 1 + face
        self.normal[painted] = normals[face]
        self.pieces += len(offsets) - 1

    def _polygon(self, corners):
        """Window, depth and normal of a polygon; None when it faces away or covers no pixel."""
        normal = normal_of(corners)
        if not normal[2] > 1e-6:
            return None
        window = self._window(corners.min(axis=0), corners.max(axis=0))
        u, v = self.u[window[1]][None, :], self.v[window[0]][:, None]
        if not u.size or not v.size:
            return None
        inside = np.ones((v.size, u.size), dtype=bool)
        points = corners.tolist()
        for a, b in zip(points, points[1:] + points[:1], strict=True):
            inside &= (b[0] - a[0]) * (v - a[1]) >= (b[1] - a[1]) * (u - a[0])
        if not inside.any():
            return None
        u0, v0, w0 = points[0]
        depth = w0 - (normal[0] / normal[2]) * (u - u0) - (normal[1] / normal[2]) * (v - v0)
        return window, np.where(inside, depth, -np.inf), normal

    def hidden_by(self, polygons: Iterable[np.ndarray]) -> int:
        """How many pixels of what is painted these polygons would hide."""
        hidden = 0
        for corners in polygons:
            found = self._polygon(corners)
            if found is not None:
                window, depth, _ = found
                hidden += np.count_nonzero((self.item[window] != NOTHING) & (depth > self.depth[window]))
        return hidden

    def sees(self, points: np.ndarray, slack: float) -> np.ndarray:
        """Which points nothing hides that is nearer by more than `slack` [m]; points outside of the picture are not seen."""
        columns, rows = ((points[:, k] - self.box[2 * k]) * self.scale for k in (0, 1))
        columns, rows = columns.astype(int), rows.astype(int)
        inside = (columns >= 0) & (columns < self.width) & (rows >= 0) & (rows < self.height)
        inside[inside] = self.depth[rows[inside], columns[inside]] <= points[inside, 2] + slack
        return inside

    def add_tubes(self, starts: np.ndarray, ends: np.ndarray, radii: np.ndarray, items: np.ndarray) -> None:
        """Round bars with round ends."""
        for start, end, radius, item in zip(starts, ends, radii, items, strict=True):
            self.pieces += 1
            self._bar(start, end, radius, item)
            for centre in (start, end):
                self._sphere(centre, radius, item)

    def _bar(self, start, end, radius, item):
        """The cylinder between two points: the nearer of the two crossings of each pixel's ray."""
        way = end - start
        length = np.linalg.norm(way)
        if not length > 0:
            return
        axis = way / length
        across = 1 - axis[2] ** 2
        if not across > 1e-9:
            return  # seen along its axis: its end covers it
        window = self._window(np.minimum(start, end) - radius, np.maximum(start, end) + radius)
        u, v = self.u[window[1]][None, :] - start[0], self.v[window[0]][:, None] - start[1]
        if not u.size or not v.size:
            return
        along = u * axis[0] + v * axis[1]
        # (q - (q . axis) axis)^2 = radius^2 for q = (u, v, w), a quadratic in w.
        half = -along * axis[2]
        root = half**2 - across * (u**2 + v**2 - along**2 - radius**2)
        w = (-half + np.sqrt(np.maximum(root, 0))) / across
        place = along + w * axis[2]
        inside = (root > 0) & (place >= 0) & (place <= length)
        if not inside.any():
            return
        normal = np.stack(np.broadcast_arrays(u, v, w), axis=-1) - place[..., None] * axis
        self._paint(window, np.where(inside, start[2] + w, -np.inf), normal / radius, item)

    def image(self, colours: np.ndarray, reach: float, edge: float = 0.6) -> np.ndarray:
        """Red, green, blue and opacity; colours: one row per item; reach: how far shadows of corners go [m]."""
        covered = self.item != NOTHING
        light = LIGHT / np.linalg.norm(LIGHT)
        facing = np.clip(self.normal @ light.astype(np.float32), 0, 1)
        # Light from the sky fills what the lamp does not reach.
        shade = 0.60 + 0.06 * self.normal[..., 1] + 0.38 * facing
        gloss = 0.16 * np.clip(self.normal @ _half_way(light), 0, 1) ** 40
        shade = shade * self._open_sky(reach) * np.where(self._edges(), 1 - edge, 1)
        red_green_blue = np.zeros((*self.item.shape, 3), dtype=np.float32)
        red_green_blue[covered] = colours[self.item[covered]]
        red_green_blue = np.clip(red_green_blue * shade[..., None] + gloss[..., None], 0, 1) * covered[..., None]
        opacity = _coarser(covered.astype(np.float32)[..., None], self.FINE)
        mean = _coarser(red_green_blue, self.FINE)
        return np.concatenate([mean / np.maximum(opacity, 1e-6), opacity], axis=-1)

    def _edges(self):
        """Pixels beside another piece that is farther away, or that meets theirs in an edge."""
        edges = np.zeros(self.item.shape, dtype=bool)
        for axis in (0, 1):
            for step in (-1, 1):
                there = np.roll(self.piece, step, axis)
                farther = np.roll(self.depth, step, axis) <= self.depth
                edges |= (there != self.piece) & farther & (self.piece != NOTHING)
        return edges

    def _open_sky(self, reach):
        """Share of light that the neighbourhood leaves: a pixel with others before its own plane lies in a corner."""
        some = (slice(None, None, self.FINE),) * 2
        depth = np.where(np.isfinite(self.depth[some]), self.depth[some], np.nan).astype(np.float32)
        normal = self.normal[some]
        steep = -normal[..., :2] / np.maximum(normal[..., 2:], 0.15)
        closed = np.zeros(depth.shape, dtype=np.float32)
        # Few looks around would show as rays in a wide shadow.
        reach = min(reach, 30 * self.FINE / self.scale)
        rings = ((0.25, 6), (0.55, 8), (0.9, 10))
        for share, directions in rings:
            for k in range(directions):
                angle = 2 * np.pi * (k + share) / directions
                du, dv = (round(share * reach * self.scale / self.FINE * way(angle)) for way in (np.cos, np.sin))
                plane = depth + (steep[..., 0] * du + steep[..., 1] * dv) * (self.FINE / self.scale)
                above = (_shifted(depth, dv, du) - plane) / (share * reach)
                # What is far in front is another thing altogether and shadows little.
                closed += np.nan_to_num(np.clip(above, 0, 1) * np.clip(2.5 - above, 0, 1))
        open_ = 1 - 0.5 * np.clip(1.6 * _smooth(closed) / sum(ring[1] for ring in rings), 0, 1)
        return np.repeat(np.repeat(open_, self.FINE, axis=0), self.FINE, axis=1)


def normal_of(corners: np.ndarray) -> np.ndarray:
    """Unit normal of a polygon by the sum over its edges; zero for one without area."""
    # Much quicker than numpy's cross product for the few corners of a face.
    first, *others = corners.tolist()
    arms = [(p[0] - first[0], p[1] - first[1], p[2] - first[2]) for p in others]
    x = y = z = 0.0
    for a, b in zip(arms[:-1], arms[1:], strict=True):
        x += a[1] * b[2] - a[2] * b[1]
        y += a[2] * b[0] - a[0] * b[2]
        z += a[0] * b[1] - a[1] * b[0]
    total = np.array([x, y, z])
    length = np.linalg.norm(total)
    return total / length if length > 0 else np.zeros(3)


def _half_way(light):
    """Between the light and the viewer: surfaces that face there shine."""
    half = light + (0, 0, 1)
    return (half / np.linalg.norm(half)).astype(np.float32)


def _shifted(values, rows, columns):
    """Values moved by whole pixels; not a number where nothing comes from."""
    moved = np.full_like(values, np.nan)
    height, width = values.shape
    if abs(rows) < height and abs(columns) < width:
        moved[max(0, -rows) : height - max(0, rows), max(0, -columns) : width - max(0, columns)] = \
            values[max(0, rows) : height - max(0, -rows), max(0, columns) : width - max(0, -columns)]
    return moved


def _smooth(values):
    """Means over five by five pixels."""
    for axis in (0, 1):
        values = sum(np.roll(values, step, axis) for step in range(-2, 3)) / 5
    return values


def _coarser(values, n):
    """Means of blocks of n x n pixels."""
    height, width, depth = values.shape
    return values.reshape(height // n, n, width // n, n, depth).mean(axis=(1, 3))
