"""The command `splitgrain convert DATBOX DECK.toml` with a script of LMGC90: its keys go to the program as settings."""

import os
import subprocess
import sys
from argparse import Namespace

from ..errors import ScriptError
from .calls import keys_of
from .script import read_script

EXIT_BAD_INPUT = 2


def convert(arguments: Namespace) -> int:
    """Read the script, then have the program write the deck; returns the exit code."""
    if int(os.environ.get("OMPI_COMM_WORLD_SIZE", os.environ.get("PMI_SIZE", "1"))) > 1:
        print("error: a script is read by one process: call convert without mpiexec", file=sys.stderr)
        return EXIT_BAD_INPUT
    try:
        keys = keys_of(read_script(arguments.script))
    except ScriptError as error:
        print(error.report(), file=sys.stderr)
        return error.code
    for warning in keys.warnings:
        print(warning.report("warning"), file=sys.stderr)
    settings = [f"{key}={value} # {arguments.script.name}:{line}" for key, (value, line) in keys.values.items()]
    words = ["convert", arguments.source, arguments.target, "--script", "none"]
    for setting in settings + arguments.set:
        words += ["--set", setting]
    return subprocess.run([os.environ["SPLITGRAIN_PROGRAM"], *words], check=False).returncode
