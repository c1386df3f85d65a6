"""Look at the results of SplitGrain: read them as numpy arrays, draw the scene, energies and solver effort.

    from splitgrain_postpro import Results
    results = Results("collapsing_column.results")
    results.record["kinetic_energy"]    # one value per row of record.csv
    results.contacts.step(-1).cell_data["force_normal"]
"""

from .errors import ResultsError
from .results import Results

__all__ = ["Results", "ResultsError"]
