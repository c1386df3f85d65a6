"""SplitGrain from Python: change decks, run them, read what they wrote, sweep over parameters.

    import splitgrain as sg

    deck = sg.Deck("input_decks/sliding_block.toml")
    deck["law"][0]["friction"] = 0.4
    run = deck.run(ranks=2, set={"output.record_every": 10})
    run.record["kinetic_energy"]            # a pandas DataFrame where there is pandas, else a dictionary of numpy arrays

    sweep = sg.sweep(deck, {"law[1].friction": [0.2, 0.3], "sample.seed": range(3)}, jobs=2)
    sweep.statistics("compactness", over="sample.seed")
"""

from .deck import Deck, polyhedron
from .errors import DeckError, RunError, Stopped
from .program import program_path, version
from .run import Run, Transformations
from .sweep import Sweep, sweep

__all__ = ["Deck", "DeckError", "Run", "RunError", "Stopped", "Sweep", "Transformations", "polyhedron", "program_path", "sweep", "version"]
