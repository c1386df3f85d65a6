"""Help of the command line: the standard library is enough for it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

POSTPRO = Path(__file__).parents[1]


@pytest.mark.parametrize("words", [["--help"], ["scene", "--help"], ["study", "--help"]])
def test_help_needs_no_package(words):
    # -S leaves out all packages that are installed.
    done = subprocess.run([sys.executable, "-P", "-S", "-m", "splitgrain_postpro", *words], text=True, capture_output=True,
                          env={**os.environ, "PYTHONPATH": str(POSTPRO)})
    assert (done.returncode, done.stderr) == (0, "")
    assert "usage:" in done.stdout


def test_missing_package_is_one_sentence(tmp_path):
    done = subprocess.run([sys.executable, "-P", "-S", "-m", "splitgrain_postpro", "scene", str(tmp_path)], text=True,
                          capture_output=True, env={**os.environ, "PYTHONPATH": str(POSTPRO)})
    assert done.returncode == 2 and done.stderr.startswith("error: looking at results needs the Python package ")
    assert done.stderr.count("\n") == 1
