"""Coarse-grained fields of a run: VTKHDF image data in time, and a page of sections through them."""

from pathlib import Path

import h5py
import numpy as np
from matplotlib.figure import Figure

from .errors import ResultsError
from .style import new_figure

#: Panels of the page: title, array, how a number follows from its components, unit.
PANELS = (
    ("solid fraction", "solid_fraction", lambda a: a, ""),
    ("speed", "velocity", lambda a: np.linalg.norm(a, axis=-1), "m/s"),
    ("pressure", "stress", lambda a: np.trace(a.reshape(*a.shape[:-1], 3, 3), axis1=-2, axis2=-1), "Pa"),
    ("shear rate", "velocity_gradient", lambda a: _shear_rate(a), "1/s"),
)


class Field:
    """The grids of one field_N.vtkhdf: axes of arrays are time, x, y, z and, where there are several, components."""

    def __init__(self, path: Path):
        self.path = Path(path)
        try:
            with h5py.File(self.path, "r") as file:
                root = file["VTKHDF"]
                n = int(root["Steps"].attrs["NSteps"])
                self.times = np.asarray(root["Steps/Values"][:n], dtype=float)
                self.steps = np.asarray(file["step"][:n])
                self.origin = np.asarray(root.attrs["Origin"], dtype=float)
                self.spacing = np.asarray(root.attrs["Spacing"], dtype=float)
                self.names = tuple(root["CellData"])
        except (OSError, KeyError, ValueError) as error:
            raise ResultsError(f"cannot read {self.path}: {error}") from error
        if not self.names:
            raise ResultsError(f"cannot read {self.path}: it holds no arrays")

    def __getitem__(self, name: str) -> np.ndarray:
        """One array of all grids, read now; tensors have nine components, row by row."""
        with h5py.File(self.path, "r") as file:
            if name not in self.names:
                raise ResultsError(f"{self.path} has no array {name}; it has {', '.join(self.names)}")
            values = np.asarray(file["VTKHDF/CellData"][name][: len(self.times)], dtype=float)
        return np.swapaxes(values, 1, 3)

    @property
    def cells(self) -> tuple[int, int, int]:
        """Cells along each axis."""
        return self["density"].shape[1:4]

    @property
    def volume(self) -> float:
        """Volume of a cell [m3]; in the plane its area [m2]."""
        return float(np.prod(self.spacing))

    def centres(self, axis: int) -> np.ndarray:
        """Coordinates of the centres of cells along an axis [m]."""
        return self.origin[axis] + (np.arange(self.cells[axis]) + 0.5) * self.spacing[axis]

    def index_of(self, step: int | None) -> int:
        """Place of the last grid not after a step; the last one where none is given."""
        if not len(self.steps):
            raise ResultsError(f"{self.path} holds no grid yet")
        found = np.flatnonzero(self.steps <= step) if step is not None else np.array([len(self.steps) - 1])
        if not len(found):
            raise ResultsError(f"{self.path} has no grid up to step {step}: the first is of step {self.steps[0]}")
        return int(found[-1])


def field_figure(field: Field, name: str, step: int | None = None) -> tuple[Figure, list[str]]:
    """Four sections of a grid: through the middle of y in space, of the plane all of it; cells without grains stay white."""
    i = field.index_of(step)
    is_in_space = field.cells[2] > 1
    middle = field.cells[1] // 2
    section = (slice(None), middle) if is_in_space else (slice(None), slice(None), 0)
    filled = field["density"][i][section] > 0
    across, up = field.origin[0], field.origin[2 if is_in_space else 1]
    wide, high = (n * s for n, s in zip(filled.shape, field.spacing[[0, 2 if is_in_space else 1]], strict=True))
    figure = new_figure(11, 11 * min(1.2, max(0.4, 0.9 * high / wide)))
    for ax, (title, array, number, unit) in zip(figure.subplots(2, 2).flat, PANELS, strict=True):
        mean_of = (3 if is_in_space else 2) if array == "stress" else 1
        values = np.where(filled, number(field[array][i][section]) / mean_of, np.nan)
        image = ax.imshow(values.T, origin="lower", extent=(across, across + wide, up, up + high), cmap="viridis")
        figure.colorbar(image, ax=ax, shrink=0.8, label=unit and f"[{unit}]")
        ax.grid(False)
        ax.set(title=title, xlabel="x [m]", ylabel="z [m]" if is_in_space else "y [m]")
    figure.suptitle(f"{name}, {field.path.stem}, {field.times[i]:.4g} s")
    return figure, []


def _shear_rate(gradient):
    """Rate of shear of each cell, sqrt(2 D':D') with D' the deviator of the symmetric part, of the plane's where z has none."""
    full = gradient.reshape(*gradient.shape[:-1], 3, 3)
    rate = (full + np.swapaxes(full, -1, -2)) / 2
    size = 3 if np.any(full[..., 2, :]) or np.any(full[..., :, 2]) else 2
    rate = rate[..., :size, :size]
    trace = np.trace(rate, axis1=-2, axis2=-1) / size
    return np.sqrt(2 * np.sum((rate - trace[..., None, None] * np.eye(size)) ** 2, axis=(-2, -1)))
