"""How far a curve lies out of the band of others, and how far those others lie out of the band of their peers.

Runs of a chaotic process differ however they are made. Whether a new one is of their kind is judged by the same question asked
of each of them: the band of all but one is held against that one (left out), and the new one against every such band.
"""

import numpy as np


def held_against(curve, others):
    """Share of the points of a curve that lie inside the band of others, ends included, and its largest distance out of it."""
    out = np.maximum(np.maximum(curve - others.max(0), others.min(0) - curve), 0)
    return np.mean(out == 0), out.max()


def bands(runs):
    """Each run, with all runs but that one."""
    return [(run, np.delete(runs, i, axis=0)) for i, run in enumerate(runs)]


def left_out(runs):
    """Share inside and largest distance out of each run against the others: two columns."""
    return np.array([held_against(run, others) for run, others in bands(runs)])


def newcomer(curve, runs):
    """Share inside and largest distance out of a curve that is none of the runs, mean over bands as narrow as theirs."""
    return np.mean([held_against(curve, others) for _, others in bands(runs)], axis=0)


def ranks(curve, runs):
    """At each point, how many of the runs lie below the curve."""
    return (runs < curve).sum(0)


def difference(new, runs):
    """Difference of the means of two samples of numbers, and its standard error from the scatter of the second one."""
    return new.mean() - runs.mean(), runs.std(ddof=1) * np.sqrt(1 / len(new) + 1 / len(runs))
