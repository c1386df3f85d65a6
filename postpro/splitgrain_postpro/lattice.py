"""Periodic images in a picture: of one period along x, and of a periodic cell, whose upper faces may have moved along x."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["Lattice", "cell_of", "fold_bodies"]


def cell_of(lengths: ArrayLike, tilt: float) -> np.ndarray:
    """Edges of a periodic cell as rows [m]; of the equal cells that differ by whole lengths along x the least tilted one."""
    lengths = np.asarray(lengths, dtype=float)
    edges = np.diag(lengths)
    edges[1, 0] = tilt - lengths[0] * np.round(tilt / lengths[0])
    return edges


def fold_bodies(points: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Ways by which points move into the cell at the origin with these edges, by whole edges [m]."""
    return -np.floor(points @ np.linalg.inv(edges)) @ edges


@dataclass
class Lattice:
    """Periods of a plane picture: none, one along x, or those of a cell."""

    edges: np.ndarray  # two numbers per row [m]

    @classmethod
    def of(cls, period: float, cell: np.ndarray | None) -> "Lattice":
        """Periods of a scene with a period along x, zero for none, or with a cell."""
        if cell is not None:
            return cls(cell[:2, :2])
        return cls(np.array([[period, 0.0]]) if period > 0 else np.empty((0, 2)))

    @property
    def is_cell(self) -> bool:
        """Are both axes periodic?"""
        return len(self.edges) == 2

    @property
    def corners(self) -> np.ndarray:
        """Corners of the cell, one after the other."""
        return np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) @ self.edges

    def folded(self, points: np.ndarray) -> np.ndarray:
        """Points at their places in the cell, or in the period along x."""
        if self.is_cell:
            return points + fold_bodies(points, self.edges)
        if len(self.edges):
            return points - self.edges * np.floor(points[:, :1] / self.edges[0, 0])
        return points

    def repeated(self, outlines: list[np.ndarray], view: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
        """Outlines with their images that reach into the view (x low, x high, y low, y high); and which outline each one is."""
        numbers = np.arange(len(outlines))
        if not len(self.edges) or not len(outlines):
            return outlines, numbers
        if self.is_cell:
            # Points of one outline stay together: its middle decides.
            ways = fold_bodies(np.array([outline.mean(axis=0) for outline in outlines]), self.edges)
            outlines = [outline + way for outline, way in zip(outlines, ways, strict=True)]
        low = np.array([outline.min(axis=0) for outline in outlines])
        high = np.array([outline.max(axis=0) for outline in outlines])
        images, copied = [], []
        for shift in np.stack(np.meshgrid(*[[-1, 0, 1]] * len(self.edges)), -1).reshape(-1, len(self.edges)) @ self.edges:
            reaches = (high[:, 0] + shift[0] > view[0]) & (low[:, 0] + shift[0] < view[1])
            if self.is_cell:
                reaches &= (high[:, 1] + shift[1] > view[2]) & (low[:, 1] + shift[1] < view[3])
            inside = numbers[reaches]
            images += [outlines[k] + shift for k in inside]
            copied.append(inside)
        return images, np.concatenate(copied)

    def straight(self, line: np.ndarray) -> np.ndarray:
        """A line to the nearest image of its other end; in a cell lines go there already."""
        line = np.array(line)
        if len(self.edges) == 1:
            period = self.edges[0, 0]
            line[1, 0] -= period * np.round((line[1, 0] - line[0, 0]) / period)
        return line
