"""The commands `splitgrain look COMMAND RESULTS [OPTION...]`, `splitgrain study`, which runs the program itself, `convex`, and
`splitgrain convert` with a script of LMGC90."""

import sys

from .command_line import parser
from .errors import ResultsError

EXIT_DONE, EXIT_BAD_INPUT = 0, 2
NEEDED = ("h5py", "matplotlib", "numpy")


def main(words: list[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    arguments = parser().parse_args(words)
    if arguments.command == "convex":
        return _convex(arguments)
    if arguments.command == "convert":
        from .convert.command import convert

        return convert(arguments)
    try:
        from . import drawing
        from .study.command import run_study
    except ModuleNotFoundError as error:
        if error.name not in NEEDED:
            raise
        print(f"error: looking at results needs the Python package {error.name} (pip install {' '.join(NEEDED)})", file=sys.stderr)
        return EXIT_BAD_INPUT
    if arguments.command == "study":
        return run_study(arguments)
    return _done(lambda: drawing.look(arguments))


def _convex(arguments):
    """Divide the objects of a mesh."""
    from .convex_parts import split_mesh

    return _done(lambda: print(split_mesh(arguments.mesh, arguments.output, arguments.threshold)))


def _done(command):
    """Do a command; returns its exit code."""
    try:
        command()
    except ResultsError as error:
        print(f"splitgrain-postpro: error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    return EXIT_DONE
