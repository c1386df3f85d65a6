"""One box and one scale of colours for several pictures, as a movie needs them."""

from dataclasses import dataclass

import numpy as np

from .quantities import Colouring


@dataclass
class Frame:
    """What the pictures of a movie have in common."""

    box: np.ndarray | None = None
    """Corners of what is shown [m], as the scene in the plane or in space has them"""
    scale: Colouring | None = None
    """Scale of the colours; None when nothing is coloured"""
    force: float | None = None
    """Force of the thickest line [N]"""
    pixels: int | None = None
    """Pixels of the longer side of solid pictures"""
