"""The command line of `splitgrain look`, `study` and `convex`; it needs the standard library alone, so that help needs nothing."""

import argparse
from argparse import ArgumentParser, _SubParsersAction
from pathlib import Path

# Where a scene in space is looked at from [degrees].
AZIMUTH, ELEVATION = -60.0, 22.0
LABELS = {
    "speed": "speed [m/s]", "displacement": "displacement [m]", "start_height": "height at the start [m]", "material": "material", "coordination": "contacts that carry force",
    "pressure": "mean stress of contacts [Pa]", "spin": "spin [rad/s]", "radius": "radius [m]", "mass": "mass [kg]", "id": "number", "rank": "rank", "layer": "layer of origin",
}  # fmt: skip
QUANTITIES = (*LABELS, "none")
COMMANDS = {
    "summary": "one page and a short text: scene with force chains, energies, solver effort, residuals",
    "scene": "the scene: grains coloured by a quantity, force chains, walls",
    "movie": "all pictures of a run as mp4, webp, gif or animated png, with one view and one scale",
    "page": "one offline page: a view that turns, a slider over the pictures, curves of the record",
    "thrust": "the thrust line of masonry: lines through the centres of pressure within the blocks",
    "split": "the scene by ranks: grains coloured by the rank that they belong to, contacts between ranks",
    "energy": "energies, works and losses against time",
    "solver": "sweeps, contacts, residuals and cost by phase against time",
    "trace": "errors against CPU time within the steps that were traced, and what these steps cost by phase",
    "spectrum": "power spectra of wall forces, momentum and kinetic energy ([report] spectrum)",
    "tracks": "columns of the tracked bodies against time ([[track]])",
    "regions": "indicators in the boxes of [[region]] against time: compactness, coordination, volume error, contacts, speeds",
    "walls": "pressure, force and place of the walls against time, strains and void ratio of the cell that they enclose",
    "field": "sections of a coarse-grained field ([[field]]): solid fraction, speed, pressure, shear rate",
    "structure": "radial distribution g(r) and structure factor S(k) of the packing",
}


def parser() -> ArgumentParser:
    """The command line."""
    top = argparse.ArgumentParser(prog="splitgrain look", description="Draw the results of a SplitGrain run.")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, sentence in COMMANDS.items():
        command = commands.add_parser(name, help=sentence, description=sentence)
        command.add_argument("results", metavar="RESULTS", help="folder that the run wrote")
        if name == "movie":
            _add_movie(command)
        elif name == "page":
            command.add_argument("--output", metavar="HTML", type=Path, help="file to write (default RESULTS/page.html)")
            command.add_argument("--pictures", metavar="N", type=int, default=60, help="most pictures on the page (default 60)")
        else:
            command.add_argument("--output", metavar="PNG", type=Path, help=f"file to write (default RESULTS/{name}.png)")
            command.add_argument("--dpi", metavar="N", type=int, default=150, help="dots per inch (default 150)")
        if name in ("summary", "scene", "thrust", "split", "structure"):
            command.add_argument("--step", metavar="N", type=int,
                                 help="show the last picture at or before time step N (default: the last picture)")
        if name in ("scene", "movie"):
            command.add_argument("--colour", metavar="QUANTITY", default="speed",
                                 help=f"quantity that fills the grains (default speed): {', '.join(QUANTITIES)}, or any array of "
                                      "the pictures of bodies, of vectors with _x, _y or _z their components")
            command.add_argument("--relative-to", metavar="BODY", help="body, by its name in the deck or its number, relative to "
                                                                         "which displacement and speed are")
        if name == "field":
            command.add_argument("--number", type=int, default=1, help="place of the field in the deck (default 1)")
            command.add_argument("--at", metavar="STEP", type=int, help="last grid up to this step (default the last one)")
        if name == "walls":
            command.add_argument("--wall", metavar="PATTERN", default="*", help="walls to draw, by name with * and ? (default *)")
        if name in ("tracks", "regions"):
            word, usual = ("body", "displacement, mean force and torque, work") if name == "tracks" else ("region", "the indicators")
            command.add_argument(f"--{word}", metavar="PATTERN", default="*", help=f"which {word} to draw, by name with * and ? (default *)")
            command.add_argument("--columns", metavar="NAME,...", type=lambda words: words.split(","),
                                 help=f"columns to draw, one panel each (default: {usual})")
        if name in ("scene", "movie", "thrust", "split"):
            space = command.add_argument_group("scenes in space")
            space.add_argument("--azimuth", metavar="DEGREES", type=float, default=AZIMUTH,
                               help=f"where to look from: angle from x towards y (default {AZIMUTH:g})")
            space.add_argument("--elevation", metavar="DEGREES", type=float, default=ELEVATION,
                               help=f"where to look from: angle above the horizon (default {ELEVATION:g})")
            space.add_argument("--cut", metavar="AXIS=PLACE", type=_cut,
                               help="leave out grains whose centres lie before this plane, for example y=0.15")
        if name in ("scene", "movie"):
            command.add_argument("--forces", action="store_true",
                                 help="draw the forces between bodies through their centres of pressure; in space on pale grains")
    add_study(commands)
    _add_convex(commands)
    _add_convert(commands)
    return top


def _add_convex(commands):
    """The command line of `convex`."""
    sentence = "divide non-convex objects of an OBJ file into convex parts, which [[blocks]] reads as one body per object"
    command = commands.add_parser("convex", help=sentence, description=sentence, prog="splitgrain convex")
    command.add_argument("mesh", metavar="MESH.obj", type=Path, help="file with closed surfaces")
    command.add_argument("--output", metavar="FILE", type=Path, help="OBJ file to write (default MESH.convex.obj)")
    command.add_argument("--threshold", metavar="SHARE", type=float, default=0.05,
                         help="concavity of a part over the size of its object, 0.01 to 1 (default 0.05)")


def _add_movie(command):
    """Options of movies alone."""
    command.add_argument("--output", metavar="FILE", type=Path,
                         help="file to write: .mp4 (by ffmpeg), .webp, .gif or .png (default RESULTS/movie.mp4, without ffmpeg movie.webp)")
    command.add_argument("--rate", metavar="N", type=_positive, default=20.0, help="pictures per second (default 20)")
    command.add_argument("--size", metavar="N", type=int, default=900, help="pixels of the longer side (default 900)")
    command.add_argument("--first", metavar="STEP", type=int, default=0, help="leave out pictures before this time step")
    command.add_argument("--last", metavar="STEP", type=int, help="leave out pictures after this time step")
    command.add_argument("--every", metavar="N", type=int, default=1, help="take one of N pictures (default 1)")


def _positive(word):
    """A number above zero."""
    try:
        value = float(word)
    except ValueError:
        value = 0.0
    if not 0 < value < 1e4:
        raise argparse.ArgumentTypeError(f"pictures per second are a number above zero, not {word}")
    return value


def add_study(commands: _SubParsersAction) -> None:
    """The command line of `study`."""
    sentence = "run a study: cases x variants x tolerances, time steps or subdomains; error against work"
    command = commands.add_parser("study", help=sentence, description=sentence, prog="splitgrain study")
    command.add_argument("study", metavar="STUDY.toml", type=Path, help="what to run (doc/guide/studies.md); a folder of studies that were run gets an index.html")
    command.add_argument("--output", metavar="DIR", type=Path, help="folder of the study (default: NAME.study here)")
    command.add_argument("--jobs", metavar="N", help="runs at a time, or all for one per core (default: that of the study)")
    command.add_argument("--part", metavar="K/N", help="with [[vary]]: part K of N of the runs, and no page: a task of a job array")
    command.add_argument("--program", metavar="PATH", help="the splitgrain to run")


def _add_convert(commands):
    """The command line of `convert` where a script is read; the program handles all other conversions."""
    sentence = "write a deck that uses a DATBOX of LMGC90, with what its script gives"
    command = commands.add_parser("convert", help=sentence, description=sentence, prog="splitgrain convert")
    command.add_argument("source", metavar="DATBOX")
    command.add_argument("target", metavar="DECK.toml")
    command.add_argument("--script", metavar="FILE", type=Path, required=True, help="script of LMGC90")
    command.add_argument("--set", metavar="SECTION.KEY=VALUE", action="append", default=[], help="key to write into the deck")


def _cut(words):
    """A plane "y=0.15" as its axis and place."""
    axis, _, place = words.partition("=")
    if axis not in ("x", "y", "z"):
        raise argparse.ArgumentTypeError(f"a cut is written like y=0.15, not {words}")
    try:
        return "xyz".index(axis), float(place)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"a cut is written like y=0.15, not {words}") from error
