"""Calibration by GrainLearning: the friction of a block from its way in time, with a spread (PyPI: grainlearning).

    python3 grainlearning_friction.py [FOLDER]
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from grainlearning import BayesianCalibration
from grainlearning.dynamic_systems import DynamicSystem

import splitgrain as sg

DECK = Path(__file__).parents[2] / "input_decks/sliding_block.toml"
TIMES = np.array([0.1, 0.2, 0.3, 0.4])
# What was measured: the way of a block of 1 m/s with a friction of 0.2 [m].
MEASURED = TIMES - 0.5 * 0.2 * 9.81 * TIMES**2


def way(run):
    """Way of the block at the times of the measurement [m]."""
    track = run.results.tracks["block"]
    return np.interp(TIMES, track["time"], track["displacement"])


def calibrate(folder, iterations=3, samples=8):
    """Mean and coefficient of variation of the friction after some iterations."""
    deck = sg.Deck(DECK)
    deck["track"] = [{"body": "block"}]
    deck["output"] = {"record_every": 10}
    deck["time"]["steps"] = 400

    def run_sim(calibration):
        """The callback of GrainLearning: one run per sample, kept in the folder of the iteration."""
        system = calibration.system
        values = {"law[1].friction": [float(friction) for friction in system.param_data[:, 0]]}
        sweep = sg.sweep(deck, values, output=Path(folder) / f"iteration_{calibration.curr_iter}", jobs=2)
        system.set_sim_data([way(run)[np.newaxis] for run in sweep.runs])

    calibration = BayesianCalibration.from_dict({
        "num_iter": iterations, "callback": run_sim, "save_fig": -1,
        "system": {"system_type": DynamicSystem, "param_names": ["friction"], "param_min": [0.05], "param_max": [0.6],
                   "num_samples": samples, "obs_data": MEASURED[np.newaxis], "obs_names": ["way"], "ctrl_data": TIMES, "ctrl_name": "time",
                   "sim_name": "block"},
        "inference": {"Bayes_filter": {"ess_target": 0.3}, "sampling": {"max_num_components": 1, "random_state": 0, "slice_sampling": True},
                      "initial_sampling": "halton"},
    })  # fmt: skip
    calibration.run()
    # The last iteration has weights of its own.
    return float(calibration.get_most_prob_params()[0]), float(calibration.system.estimated_params_cv[-1, 0])


if __name__ == "__main__":
    with TemporaryDirectory() as place:
        friction, spread = calibrate(sys.argv[1] if len(sys.argv) > 1 else place)
    print(f"friction = {friction:.3f}, coefficient of variation {spread:.2f}")
