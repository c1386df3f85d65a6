"""The command `splitgrain-postpro COMMAND RESULTS [OPTION...]`, and `study`, which runs the program itself."""

import argparse
import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from . import fields, figures, spectra, tracks
from .errors import ResultsError
from .results import Results
from .scene import QUANTITIES
from .space import View
from .study.command import add_command, run_study
from .style import styled
from .text import summary_text

EXIT_DONE, EXIT_BAD_INPUT = 0, 2
COMMANDS = {
    "summary": "one page and a short text: scene with force chains, energies, solver effort, residuals",
    "scene": "the scene: grains coloured by a quantity, force chains, walls",
    "split": "the scene by ranks: grains coloured by the rank that they belong to, contacts between ranks",
    "energy": "energies, works and losses against time",
    "solver": "sweeps, contacts, residuals and cost by phase against time",
    "trace": "errors against CPU time within the steps that were traced, and what these steps cost by phase",
    "spectrum": "power spectra of wall forces, momentum and kinetic energy ([report] spectrum)",
    "tracks": "columns of the tracked bodies against time ([[track]])",
    "walls": "pressure, force and place of the walls against time, strains and void ratio of the cell that they enclose",
    "field": "sections of a coarse-grained field ([[field]]): solid fraction, speed, pressure, shear rate",
    "structure": "radial distribution g(r) and structure factor S(k) of the packing",
}


def parser() -> ArgumentParser:
    """The command line."""
    top = argparse.ArgumentParser(prog="splitgrain-postpro", description="Draw the results of a SplitGrain run.")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, sentence in COMMANDS.items():
        command = commands.add_parser(name, help=sentence, description=sentence)
        command.add_argument("results", metavar="RESULTS", help="folder that the run wrote")
        command.add_argument("--output", metavar="PNG", type=Path, help=f"file to write (default RESULTS/{name}.png)")
        command.add_argument("--dpi", metavar="N", type=int, default=150, help="dots per inch (default 150)")
        if name in ("summary", "scene", "split", "structure"):
            command.add_argument("--step", metavar="N", type=int,
                                 help="show the last picture at or before time step N (default: the last picture)")
        if name == "scene":
            command.add_argument("--colour", choices=QUANTITIES, default="speed",
                                 help="quantity that fills the grains (default speed)")
        if name == "field":
            command.add_argument("--number", type=int, default=1, help="place of the field in the deck (default 1)")
            command.add_argument("--at", metavar="STEP", type=int, help="last grid up to this step (default the last one)")
        if name == "walls":
            command.add_argument("--wall", metavar="PATTERN", default="*", help="walls to draw, by name with * and ? (default *)")
        if name == "tracks":
            command.add_argument("--body", metavar="PATTERN", default="*", help="bodies to draw, by name with * and ? (default *)")
            command.add_argument("--columns", metavar="NAME,...", type=lambda words: words.split(","),
                                 help="columns to draw, one panel each (default: displacement, mean force and torque, work)")
        if name in ("scene", "split"):
            space = command.add_argument_group("scenes in space")
            space.add_argument("--azimuth", metavar="DEGREES", type=float, default=View.azimuth,
                               help=f"where to look from: angle from x towards y (default {View.azimuth:g})")
            space.add_argument("--elevation", metavar="DEGREES", type=float, default=View.elevation,
                               help=f"where to look from: angle above the horizon (default {View.elevation:g})")
            space.add_argument("--cut", metavar="AXIS=PLACE", type=_cut,
                               help="leave out grains whose centres lie before this plane, for example y=0.15")
        if name == "scene":
            space.add_argument("--forces", action="store_true",
                               help="draw the forces between grains, and the grains pale")
    add_command(commands)
    return top


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
            figure, missing = figures.scene_figure(results, picture, arguments.colour, _view(arguments))
        elif arguments.command == "split":
            figure, missing = figures.split_figure(results, picture, _view(arguments))
        elif arguments.command == "spectrum":
            figure, missing = spectra.spectrum_figure(results)
        elif arguments.command == "tracks":
            figure, missing = tracks.tracks_figure(results, arguments.body, arguments.columns)
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


def main(words: list[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    arguments = parser().parse_args(words)
    if arguments.command == "study":
        return run_study(arguments)
    try:
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
    except ResultsError as error:
        print(f"splitgrain-postpro: error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    return EXIT_DONE


def _cut(words):
    """A plane "y=0.15" as its axis and place."""
    axis, _, place = words.partition("=")
    if axis not in ("x", "y", "z"):
        raise argparse.ArgumentTypeError(f"a cut is written like y=0.15, not {words}")
    try:
        return "xyz".index(axis), float(place)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"a cut is written like y=0.15, not {words}") from error


def _view(arguments):
    """How to look at a scene in space."""
    return View(arguments.azimuth, arguments.elevation, getattr(arguments, "forces", False), arguments.cut)


def _write(path, write):
    """Write a file, or report why it cannot be written."""
    try:
        write()
    except OSError as error:
        raise ResultsError(f"cannot write {path}: {error.strerror or error}") from error
