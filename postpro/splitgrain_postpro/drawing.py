"""What the commands of `splitgrain look` do: read results, draw the page, write it."""

import sys
from argparse import Namespace
from pathlib import Path

from . import fields, figures, spectra, tracks
from .errors import ResultsError
from .quantities import need_quantity
from .results import Results
from .space import View
from .style import styled
from .text import summary_text
from .viewer import write_page


def look(arguments: Namespace) -> None:
    """Do one command and print what it wrote."""
    if arguments.command == "movie":
        _movie(arguments)
        return
    if arguments.command == "page":
        results = Results(arguments.results)
        _write(arguments.output or results.folder / "page.html", lambda: print(write_page(results, arguments)))
        return
    results, missing, output = draw(arguments)
    if arguments.command == "summary":
        text = summary_text(results, missing)
        path = output.with_name("summary.txt") if output.stem == "summary" else output.with_suffix(".txt")
        _write(path, lambda: path.write_text(text))
        print(text, end="")
    else:
        for sentence in missing:
            print(f"splitgrain-postpro: {sentence}", file=sys.stderr)
    print(f"wrote {output}")


def _movie(arguments):
    """Write the movie of a run."""
    from .movie import make_movie  # Pillow is asked for by movies alone

    results = Results(arguments.results)
    need_quantity(results.scene(-1), arguments.colour)
    with styled():
        try:
            sentence, missing = make_movie(results, arguments)
        except OSError as error:
            raise ResultsError(f"cannot write the movie: {error.strerror or error}") from error
    for line in missing:
        print(f"splitgrain-postpro: {line}", file=sys.stderr)
    print(sentence)


def draw(arguments: Namespace) -> tuple[Results, list[str], Path]:
    """Make the page of a command; returns the results read and what was not there."""
    results = Results(arguments.results)
    picture = -1
    if getattr(arguments, "step", None) is not None:
        picture = results.picture_of_step(arguments.step)
    with styled():
        if arguments.command == "summary":
            figure, missing = figures.summary_figure(results, picture)
        elif arguments.command == "scene":
            figure, missing = figures.scene_figure(results, picture, arguments.colour, _view(arguments), arguments.relative_to)
        elif arguments.command == "thrust":
            figure, missing = figures.thrust_figure(results, picture, _view(arguments))
        elif arguments.command == "split":
            figure, missing = figures.split_figure(results, picture, _view(arguments))
        elif arguments.command == "spectrum":
            figure, missing = spectra.spectrum_figure(results)
        elif arguments.command == "tracks":
            figure, missing = tracks.tracks_figure(results, arguments.body, arguments.columns)
        elif arguments.command == "regions":
            figure, missing = tracks.regions_figure(results, arguments.region, arguments.columns)
        elif arguments.command == "field":
            figure, missing = fields.field_figure(results.field(arguments.number), results.name, arguments.at)
        elif arguments.command == "walls":
            figure, missing = tracks.walls_figure(results, arguments.wall)
        elif arguments.command == "structure":
            figure, missing = spectra.structure_figure(results, picture)
        elif arguments.command == "energy":
            figure, missing = figures.energy_figure(results)
        elif arguments.command == "trace":
            figure, missing = figures.trace_figure(results)
        else:
            figure, missing = figures.solver_figure(results)
        output = arguments.output or results.folder / f"{arguments.command}.png"
        figure.draw_without_rendering()  # the first layout ignores how a fixed aspect shifts labels
        _write(output, lambda: figure.savefig(output, format="png", dpi=arguments.dpi))
    return results, missing, output


def _view(arguments):
    """How to look at a scene in space."""
    return View(arguments.azimuth, arguments.elevation, forces=getattr(arguments, "forces", False), cut=arguments.cut)


def _write(path, write):
    """Write a file, or report why it cannot be written."""
    try:
        write()
    except OSError as error:
        raise ResultsError(f"cannot write {path}: {error.strerror or error}") from error
