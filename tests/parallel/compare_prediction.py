#!/usr/bin/env python3
"""Compare the predicted cost of an iteration with a measured one: compare_prediction.py PROGRAM DECK [--ranks 2] [--gluing dual]

`splitgrain partition --predict` runs on the ranks and times updates, gluing and messages; then the deck runs one step on
them, with few and with many iterations, and the difference of the two is what iterations cost. Both are printed, with
their ratio; nothing is asserted about times. Ranks need a core each, or both sides measure the scheduler.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path


def launch(ranks, *words):
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    # Open MPI puts sockets into TMPDIR, and their paths must be short.
    environment.pop("TMPDIR", None)
    launcher = ["mpiexec", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
    return subprocess.run([*launcher, *map(str, words)], env=environment, capture_output=True, text=True, check=True).stdout


def measured(program, deck, ranks, gluing, iterations, place):
    """Run a step with a number of iterations that no tolerance cuts short."""
    folder = place / str(iterations)
    launch(ranks, program, "run", deck, "--quiet", "--force", "--output", folder, "--set", "time.steps=1",
           "--set", f"solver.maximum_sweeps={iterations}", "--set", "solver.tolerance=1e-15",
           "--set", f'partition.gluing="{gluing}"', "--set", "output.every=0")
    return json.loads((folder / "run.json").read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("deck")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--gluing", choices=("dual", "primal"), default="dual")
    parser.add_argument("--iterations", type=int, default=400)
    parser.add_argument("--tries", type=int, default=3, help="runs of each; the shortest is the undisturbed one")
    chosen = parser.parse_args()
    program = str(Path(chosen.program).resolve())
    told = json.loads(launch(chosen.ranks, program, "partition", chosen.deck, "--parts", chosen.ranks, "--predict", "--json"))
    prefix = f"ranks_{chosen.ranks}_{chosen.gluing}_"
    few, many = chosen.iterations // 4, chosen.iterations
    ends = {few: [], many: []}
    with tempfile.TemporaryDirectory() as place:
        for _ in range(chosen.tries):
            for iterations, runs in ends.items():
                runs.append(measured(program, chosen.deck, chosen.ranks, chosen.gluing, iterations, Path(place)))

    def of_an_iteration(key):
        """The shortest of some runs is the undisturbed one: a difference of shortest ones, not the shortest difference."""
        return (min(run[key] for run in ends[many]) - min(run[key] for run in ends[few])) / (many - few)

    wall, cpu = of_an_iteration("wall_solve"), of_an_iteration("cpu_solve") / chosen.ranks
    updates = of_an_iteration("rank_updates_max" if chosen.ranks > 1 else "contact_updates")
    # Runs leave out contacts that have opened; what they leave out is taken off the prediction too.
    visited = updates / told[f"ranks_{chosen.ranks}_largest"]
    whole = told[prefix + "seconds"]
    predicted = whole - (1 - visited) * told[prefix + "sweep_seconds"]
    print(f"{chosen.deck}: {told['contacts']} contacts, {chosen.ranks} ranks, {chosen.gluing}")
    print(f"a rank updates {updates:.0f} contacts per iteration, {100 * visited:.1f} % of those it owns")
    print(f"predicted  {1e3 * predicted:.4f} ms per iteration ({1e3 * whole:.4f} ms with all contacts): updates "
          f"{1e3 * visited * told[prefix + 'sweep_seconds']:.4f}, gluing {1e3 * told[prefix + 'glue_seconds']:.4f}, "
          f"messages {1e3 * told[prefix + 'message_seconds']:.4f}")
    print(f"measured   {1e3 * wall:.4f} ms wall, {1e3 * cpu:.4f} ms CPU per rank")
    print(f"measured over predicted: {wall / predicted:.3f} wall, {cpu / predicted:.3f} CPU")


if __name__ == "__main__":
    main()
