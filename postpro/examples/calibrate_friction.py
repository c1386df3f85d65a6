"""Calibration: the friction at which a block of 1 m/s slides as far as was measured. Usage: calibrate_friction.py [METRES]

    python3 calibrate_friction.py 0.2
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from scipy.optimize import brentq

import splitgrain as sg

DECK = Path(__file__).parents[2] / "input_decks/sliding_block.toml"


def slid(friction, folder):
    """How far the block slides with this friction [m]."""
    deck = sg.Deck(DECK)
    deck["law"][0]["friction"] = friction
    deck["track"] = [{"body": "block"}]
    run = deck.run(Path(folder) / f"friction_{friction:.6f}", force=True)
    return float(run.results.tracks["block"]["displacement"][-1])


def calibrate(measured, folder):
    """Friction for a way that was measured [m]."""
    return brentq(lambda friction: slid(friction, folder) - measured, 0.1, 0.9, xtol=1e-4)


if __name__ == "__main__":
    with TemporaryDirectory() as place:
        print(f"friction = {calibrate(float(sys.argv[1]) if len(sys.argv) > 1 else 0.2, place):.4f}")
