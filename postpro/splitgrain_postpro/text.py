"""The short text about a run: from run.json, or from the record when the run has not ended."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from .results import Results
from .style import number

# Name in run.json, words, unit.
LINES = [
    ("steps", "steps", ""),
    ("unconverged_steps", "not converged", ""),
    ("time", "simulated time", "s"),
    ("bodies", "bodies", ""),
    ("contacts", "contacts", ""),
    ("active_contacts", "carrying force", ""),
    ("kinetic_energy", "kinetic energy", "J"),
    ("mean_velocity", "mean velocity", "m/s"),
    ("max_velocity", "largest velocity", "m/s"),
    ("mean_penetration", "mean penetration", "m"),
    ("max_penetration", "largest penetration", "m"),
    ("volume_error", "volume error", ""),
    ("compactness", "compactness", ""),
    ("coordination", "coordination", ""),
    ("coordination_without_rattlers", "without rattlers", ""),
    ("energy_closure", "energy balance defect", ""),
    ("sweeps", "sweeps", ""),
    ("contact_updates", "contact updates", ""),
    ("worst_e1", "worst E1", ""),
    ("worst_e2", "worst E2", ""),
    ("worst_e8", "worst E8", ""),
    ("cpu_seconds", "CPU time", "s"),
    ("wall_seconds", "wall time", "s"),
    ("ranks", "ranks", ""),
]


def facts(results: Results) -> dict[str, Any]:
    """What is known at the end of the run, or at the last row of the record while it goes on."""
    record = results.record
    known = {name: float(column[-1]) for name, column in record.items() if len(column)}
    if known:
        known["steps"] = known.pop("step", float("nan"))
        for name in ("e1", "e2", "e8"):
            if name in record and np.isfinite(record[name]).any():
                known["worst_" + name] = float(np.nanmax(record[name]))
        # A row is about its own step: what it cannot sum up for the run is left out.
        for name in ("sweeps", "contact_updates"):
            known.pop(name, None)
    known.update(results.run)
    return known


def state(results: Results) -> str:
    """How the run stands; run.json is there when the run has ended."""
    run = results.run
    if not run:
        return "not finished"
    status = run.get("status", "done")
    return status if status == "done" else f"{status}: {run.get('reason') or 'no reason given'}"


def headline(results: Results) -> str:
    """One line for the top of a page."""
    known = facts(results)
    parts = [results.name]
    if _is_known(known, "bodies"):
        parts.append(f"{_words(known['bodies'])} bodies")
    if _is_known(known, "steps"):
        parts.append(f"{_words(known['steps'])} steps")
    if _is_known(known, "time"):
        parts.append(f"t = {number(known['time'])} s")
    if _is_known(known, "cpu_seconds"):
        parts.append(f"CPU {number(known['cpu_seconds'])} s")
    parts.append(state(results))
    return "   |   ".join(parts)


def summary_text(results: Results, missing: Iterable[str] = ()) -> str:
    """The text that `summary` prints and saves: one fact per line."""
    known = facts(results)
    rows = [("run", f"{results.name}, {state(results)}")]
    rows += [(words, f"{_words(known[name])} {unit}".rstrip()) for name, words, unit in LINES if _is_known(known, name)]
    if len(results.picture_times):
        rows.append(("pictures", f"{len(results.picture_times)}, to {number(results.picture_times[-1])} s"))
    rows += [("not there", sentence) for sentence in missing]
    width = max(len(words) for words, _ in rows) + 2
    return "".join(f"{words:<{width}}{value}\n" for words, value in rows)


def _is_known(known, name):
    value = known.get(name)
    return isinstance(value, (int, float)) and np.isfinite(value)


def _words(value):
    """A whole number in groups of three, or a number in four digits."""
    return f"{int(value):,}" if float(value).is_integer() else number(value)
