"""A movie of a run: all pictures with one view, one box and one scale of colours, written by Pillow or ffmpeg."""

import os
import shutil
import subprocess
from argparse import Namespace
from collections.abc import Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from .errors import ResultsError
from .frame import Frame
from .quantities import colouring, of_bodies, relative_to
from .results import Results, Scene
from .scene import box_of, draw_scene, is_in_space, proportions, thickest_force
from .space import FILL, View
from .style import FILL as FLAT_FILL
from .style import new_figure

FORMATS = (".mp4", ".webp", ".gif", ".png")
NO_FFMPEG = ("an mp4 is written by ffmpeg, and there is none: install ffmpeg (Debian) or imageio-ffmpeg (PyPI), "
             "or ask for a .webp, .gif or animated .png")


def movie_path(results: Results, output: Path | None) -> Path:
    """File to write: mp4 where there is an ffmpeg, else webp, unless it is given."""
    path = output or results.folder / ("movie.mp4" if find_ffmpeg() else "movie.webp")
    if path.suffix not in FORMATS:
        raise ResultsError(f"{path}: a movie is one of {', '.join(FORMATS)}")
    if path.suffix == ".mp4" and not find_ffmpeg():
        raise ResultsError(NO_FFMPEG)
    return path


def find_ffmpeg() -> str | None:
    """The ffmpeg on the path, or that of the package imageio-ffmpeg."""
    if find_spec("imageio_ffmpeg"):
        import imageio_ffmpeg

        return imageio_ffmpeg.get_ffmpeg_exe()
    return shutil.which("ffmpeg")


class Movie:
    """The frames of a run."""

    def __init__(self, results: Results, pictures: list[int], quantity: str, view: View, size: int = 900, body: str | None = None):
        """pictures: their numbers; size: pixels of the longer side; body: displacements and velocities are relative to it."""
        self.results, self.pictures, self.quantity, self.view = results, pictures, quantity, view
        self.body = None if body is None else results.number_of_body(body)
        self.missing: list[str] = []
        first = self._scene(pictures[0])
        self.common = Frame(pixels=round(0.85 * size))
        self._survey(first)
        ratio = proportions(first, results.periods, view, self.common.box)
        self.figure = new_figure(7 * ratio**0.5 + 1.8, 7 / ratio**0.5 + 1)
        self.figure.set_dpi(size / max(self.figure.get_size_inches()))
        self.figure.suptitle(results.name)
        self.canvas = FigureCanvasAgg(self.figure)
        self.ax = self.figure.add_subplot()

    def _scene(self, picture: int) -> Scene:
        scene = self.results.scene(picture)
        return scene if self.body is None else relative_to(scene, self.body)

    def _survey(self, first):
        """Look at all pictures for the box about everything and the range of colours and forces."""
        boxes, values, forces = [], [], []
        for picture in self.pictures:
            scene = self._scene(picture)
            boxes.append(box_of(scene, self.results.periods))
            forces.append(thickest_force(scene) or 0.0)
            found = None if self.quantity == "none" or scene.bodies is None else of_bodies(scene, self.quantity)
            if found is not None:
                found = np.asarray(found, dtype=float)[np.asarray(scene.bodies.point_data["is_grain"]) > 0]
                values.append(found[np.isfinite(found)])
        if all(box is not None for box in boxes):
            self.common.box = _about(boxes)
        self.common.force = max(forces) or None
        values = np.concatenate(values) if values else np.empty(0)
        if len(values):
            self.common.scale = colouring(values, self.quantity, FILL if is_in_space(first) else FLAT_FILL)

    def frames(self) -> Iterator[np.ndarray]:
        """Red, green and blue of one picture after the other; both sides are even."""
        for number, picture in enumerate(self.pictures):
            self.ax.clear()
            self.missing = draw_scene(self.ax, self._scene(picture), self.quantity, self.results.periods, self.view, common=self.common)
            if number == 0:
                # The parts keep their places from the first frame on. The first layout ignores how a fixed aspect shifts labels.
                self.figure.draw_without_rendering()
                self.figure.draw_without_rendering()
                self.figure.set_layout_engine("none")
            self.canvas.draw()
            pixels = np.asarray(self.canvas.buffer_rgba())[..., :3]
            yield np.ascontiguousarray(pixels[: pixels.shape[0] // 2 * 2, : pixels.shape[1] // 2 * 2])


def _about(boxes):
    """A box about boxes: rows (low, high) of corners in space, (x low, x high, y low, y high) in the plane."""
    boxes = np.array(boxes)
    if boxes.ndim == 3:
        return np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
    return np.array([boxes[:, 0].min(), boxes[:, 1].max(), boxes[:, 2].min(), boxes[:, 3].max()])


def write_movie(movie: Movie, path: Path, rate: float) -> str:
    """Write a movie with so many pictures per second; returns a sentence about it. The file gets its name when it is whole."""
    part = path.with_name(path.name + ".part")
    start = perf_counter()
    try:
        if path.suffix == ".mp4":
            _write_mp4(movie.frames(), part, rate)
        else:
            _write_images(movie.frames(), part, path.suffix, rate)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
    seconds = (perf_counter() - start) / len(movie.pictures)
    return f"wrote {path}: {len(movie.pictures)} frames, {seconds:.2f} s per frame"


def _write_images(frames, path, suffix, rate):
    """gif, webp or animated png by Pillow; a gif has the colours of its last frame throughout."""
    images = [Image.fromarray(frame) for frame in frames]
    options = {".gif": {"format": "GIF"}, ".png": {"format": "PNG"}, ".webp": {"format": "WEBP", "quality": 85, "method": 2}}[suffix]
    if suffix == ".gif":
        palette = images[-1].quantize(256, dither=Image.Dither.NONE)
        images = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    images[0].save(path, save_all=True, append_images=images[1:], duration=round(1000 / rate), loop=0, **options)


def _write_mp4(frames, path, rate):
    """H.264 by ffmpeg, which every player takes."""
    process = None
    for frame in frames:
        if process is None:
            height, width = frame.shape[:2]
            words = [find_ffmpeg(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}",
                     "-r", f"{rate:g}", "-i", "-", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "18", "-f", "mp4", str(path)]
            process = subprocess.Popen(words, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            process.stdin.write(frame.tobytes())
        except BrokenPipeError:
            break
    printed = process.communicate()[1].decode(errors="replace").strip()
    if process.returncode:
        raise ResultsError(f"ffmpeg cannot write {path}: {printed.splitlines()[-1] if printed else 'it failed'}")


def make_movie(results: Results, options: Namespace) -> tuple[str, list[str]]:
    """The movie that a command line asks for; returns the sentence about it and what was not there."""
    path = movie_path(results, options.output)
    steps = results.picture_steps
    chosen = [k for k, step in enumerate(steps) if options.first <= step <= (options.last if options.last is not None else step)]
    chosen = chosen[:: max(1, options.every)]
    if not chosen:
        raise ResultsError(f"{results.folder} has no picture from step {options.first} to {options.last}")
    view = replace(View(), azimuth=options.azimuth, elevation=options.elevation, forces=options.forces, cut=options.cut)
    movie = Movie(results, chosen, options.colour, view, options.size, options.relative_to)
    return write_movie(movie, path, options.rate), movie.missing
