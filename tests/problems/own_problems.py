"""Contact problems of our own: steps of decks of input_decks, some made smaller, dumped as FCLIB files."""

import os
import subprocess
from pathlib import Path

SOURCE = Path(os.environ.get("SPLITGRAIN_SOURCE") or Path(__file__).resolve().parents[2])

# Name: (deck, step, what of its text becomes what).
SMALL = {
    "arch in the plane": ("arch", 50, {}),
    "150 polygons in the plane": ("polygons_settling", 800, {
        "count = 600": "count = 150", "2.0, 3.0": "1.0, 1.5", "[2.05": "[1.05", "[2.0,": "[1.0,"}),
    "arch of stones": ("arch_of_stones", 50, {}),
    "40 polyhedra": ("polyhedra_settling", 700, {"count = 500": "count = 40", "0.4, 0.4, 1.3": "0.18, 0.18, 0.6"}),
    "small brick wall": ("brick_wall", 20, {"rows = 12": "rows = 6", "columns = 8": "columns = 4"}),
}
LARGE = {
    "brick wall after the ball": ("brick_wall", 250, {}),
    "100 polyhedra": ("polyhedra_settling", 700, {"count = 500": "count = 100", "0.4, 0.4, 1.3": "0.25, 0.25, 0.7"}),
    "300 spheres": ("spheres_in_a_box", 800, {"count = 2000": "count = 300", "0.3, 0.3, 0.8": "0.15, 0.15, 0.5"}),
}


def dump(program, place, name):
    """Run a deck to the step of a problem; the file of the problem in local form, in a folder of its own below the place."""
    deck, step, changes = (SMALL | LARGE)[name]
    text = (SOURCE / "input_decks" / f"{deck}.toml").read_text()
    for old, new in changes.items():
        if old not in text:
            raise ValueError(f"{deck}.toml has no {old!r}")
        text = text.replace(old, new)
    changed, results = Path(place) / f"{name}.toml", Path(place) / f"{name}.results"
    changed.write_text(text)
    subprocess.run([program, "run", changed, "--output", results, "--dump", str(step), "--set", f"time.steps={step}",
                    "--quiet"], check=True)
    return results / f"dump-{step}-local.hdf5"
