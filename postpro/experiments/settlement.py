"""Settlement of a sleeper against the number of load cycles, and the logarithmic law through it.

usage: PYTHONPATH=postpro python3 -P postpro/experiments/settlement.py PNG RESULTS...

RESULTS is what input_decks/talk/ballast/settlement.toml leaves, one folder per sample. The settlement s_N after N cycles is how far
the sleeper has sunk since the load began to swing, at the end of cycle N, when the load is least. The law is

    s_N = a + b log10 N = a (1 + C log10 N),

by least squares over numbers of cycles that are evenly spread over log10 N, so that each decade counts alike. Coefficients are
printed for each sample, then their mean and standard deviation over the samples, and those of the mean curve, in which the jumps of
single samples even out, next to C of [SeligWaters1994].
"""

import sys

import numpy as np
from splitgrain_postpro.results import Results
from splitgrain_postpro.style import new_figure

FREQUENCY = 20.0  # Hz: as in the deck
PUBLISHED = (0.2, 0.4)  # C of SeligWaters1994


def settlement(results, frequency=FREQUENCY):
    """Settlement [m] at the start of the last stage, which is zero, and after each whole cycle since then."""
    sleeper = results.tracks["sleeper"]
    first = int(np.flatnonzero(sleeper["stage"] == sleeper["stage"].max())[0])
    time, height = sleeper["time"][first - 1 :], sleeper["y"][first - 1 :]
    cycles = int((time[-1] - time[0]) * frequency + 1e-6)
    return height[0] - np.interp(time[0] + np.arange(cycles + 1) / frequency, time, height)


def logarithmic_law(sunk):
    """Coefficients a and b [m] of s_N = a + b log10 N, and the share of the variance that the law explains."""
    number = np.unique(np.round(np.logspace(0, np.log10(len(sunk) - 1), 40)).astype(int))
    b, a = np.polyfit(np.log10(number), sunk[number], 1)
    left = sunk[number] - a - b * np.log10(number)
    return a, b, 1 - left.var() / sunk[number].var()


def draw(ax, sunk, colour, label):
    """Settlement and its law, against the number of cycles."""
    number = np.arange(1, len(sunk))
    a, b, _ = logarithmic_law(sunk)
    ax.plot(number, 1e3 * sunk[1:], color=colour, label=label)
    ax.plot(number, 1e3 * (a + b * np.log10(number)), color=colour, linestyle="--", linewidth=1)


def main(output, *folders):
    figure = new_figure(7, 4.5)
    ax = figure.subplots()
    found, curves = [], []
    for i, folder in enumerate(folders):
        results = Results(folder)
        sunk = settlement(results)
        a, b, explained = logarithmic_law(sunk)
        found.append((1e3 * a, 1e3 * b, b / a))
        curves.append(sunk)
        draw(ax, sunk, f"C{i}", f"sample {i + 1}")
        late = (sunk[-1] - sunk[len(sunk) // 2]) / (len(sunk) - 1 - len(sunk) // 2)
        print(f"{folder}: {len(sunk) - 1} cycles, s_1 {1e3 * sunk[1]:.2f} mm, last {1e3 * sunk[-1]:.2f} mm; a {1e3 * a:.2f} mm, "
              f"b {1e3 * b:.2f} mm per decade, C {b / a:.3f}, R2 {explained:.3f}; second half {1e6 * late:.2f} um per cycle; "
              f"volume error at most {100 * results.record['volume_error'].max():.3f} %")  # fmt: skip
    mean, spread = np.mean(found, axis=0), np.std(found, axis=0, ddof=min(1, len(found) - 1))
    for name, value, error in zip(("a [mm]", "b [mm per decade]", "C"), mean, spread):
        print(f"{name}: {value:.3f} +- {error:.3f} over {len(found)} samples")
    shortest = min(map(len, curves))
    together = np.mean([sunk[:shortest] for sunk in curves], axis=0)
    a, b, explained = logarithmic_law(together)
    draw(ax, together, "black", "mean")
    print(f"mean curve of {shortest - 1} cycles: a {1e3 * a:.2f} mm, b {1e3 * b:.2f} mm per decade, C {b / a:.3f}, R2 {explained:.3f}")
    print(f"published C: {PUBLISHED[0]} to {PUBLISHED[1]}")
    ax.set(xscale="log", xlabel="load cycles N", ylabel="settlement [mm]")
    ax.invert_yaxis()
    ax.legend(title="dashed: a + b log10 N")
    figure.savefig(output, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
