"""Look at the results of SplitGrain: read them as numpy arrays, draw the scene, energies and solver effort.

    from splitgrain_postpro import Results
    results = Results("collapsing_column.results")
    results.record["kinetic_energy"]    # one value per row of record.csv
    results.contacts.step(-1).cell_data["force_normal"]
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .errors import ResultsError
    from .results import Results

__all__ = ["Results", "ResultsError"]


def __getattr__(name: str) -> Any:
    """Names are imported when they are first used: help of the command line needs no package."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(".results" if name == "Results" else ".errors", __name__), name)
