"""The commands `splitgrain look COMMAND RESULTS [OPTION...]` and `splitgrain study`, which runs the program itself."""

import sys

from .command_line import parser
from .errors import ResultsError

EXIT_DONE, EXIT_BAD_INPUT = 0, 2
NEEDED = ("h5py", "matplotlib", "numpy")


def main(words: list[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    arguments = parser().parse_args(words)
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
    try:
        drawing.look(arguments)
    except ResultsError as error:
        print(f"splitgrain-postpro: error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    return EXIT_DONE
