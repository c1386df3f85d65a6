#!/usr/bin/env python3
"""The wheel in an environment of its own: the command, the package, and tables of pandas and xarray.

usage: check_wheel.py VENV
"""

import subprocess
import sys
from pathlib import Path

import pandas
import splitgrain as sg
import splitgrain_postpro
import xarray

DECK = """[scene]
gravity = [0.0, -10.0]
[time]
step = 1e-3
steps = 20
[output]
every = 10
[[material]]
name = "stone"
density = 1000.0
[[law]]
friction = 0.3
[[field]]
box = [-0.2, -0.2, 0.2, 0.2]
cells = [4, 4]
every = 10
[[body]]
name = "ball"
shape = "disk"
radius = 0.1
position = [0.0, 0.1]
"""


def main(venv):
    """Run what a user would; an assertion fails where something is not there."""
    for module in (sg, splitgrain_postpro):
        assert Path(module.__file__).is_relative_to(venv), module.__file__
    assert Path(sg.program_path()).is_relative_to(venv), sg.program_path()
    assert sg.version()["version"].startswith("0."), sg.version()
    Path("ball.toml").write_text(DECK)
    command = str(venv / "bin/splitgrain")
    printed = subprocess.run([command, "run", "ball.toml", "--quiet"], check=True, capture_output=True, text=True)
    assert printed.stderr == "", printed.stderr
    subprocess.run([command, "look", "scene", "ball.results"], check=True)
    assert Path("ball.results/scene.png").read_bytes()[:4] == b"\x89PNG"
    subprocess.run([command, "look", "page", "ball.results"], check=True)
    assert "three.js authors" in Path("ball.results/page.html").read_text("utf-8")
    run = sg.Run("ball.results")
    assert isinstance(run.record, pandas.DataFrame) and run.record.index.name == "step"
    assert isinstance(run.field(), xarray.Dataset) and run.field()["density"].dims == ("time", "x", "y", "z")
    assert abs(run.record["max_velocity"].iloc[-1] - 0.2) < 1e-9
    print(f"wheel: {sg.version()['version']} in {venv}")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
