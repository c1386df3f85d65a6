"""Settlement of a sleeper against the number of load cycles, and the logarithmic law through it with its standard error.

usage: PYTHONPATH=postpro python3 -P postpro/experiments/settlement.py PNG FOLDER...

FOLDER is what input_decks/talk/ballast/settlement.toml or settlement_in_space.toml leaves, one folder per sample, or a study of it
(input_decks/studies/settlement.toml), whose runs are the samples of one group; samples that are named one by one are a group too.
The settlement s_N after N cycles is how far the sleeper has sunk since the load began to swing, at the end of cycle N, when the load
is least. The law is

    s_N = a + b log10 N = a (1 + C log10 N),

by least squares over numbers of cycles that are evenly spread over log10 N, so that each decade counts alike. It is taken from the
mean curve of a group, in which the jumps of single samples even out, since the ratio C = b/a of one sample has no mean where a may
vanish by chance. C10 = b/(a + b) is the same coefficient counted from the tenth cycle on, s_N = s_10 (1 + C10 log10(N/10)). Standard
errors are those of the bootstrap: the law of the mean curve of as many samples, drawn from the group with repetition.
"""

import sys
from pathlib import Path

import numpy as np
from splitgrain_postpro.results import Results
from splitgrain_postpro.style import new_figure

FREQUENCY = 20.0  # Hz: as in the deck
PUBLISHED = (0.2, 0.4)  # C of SeligWaters1994
DRAWS = 4000  # of the bootstrap: its error of a standard error is 1 %
NAMES = ("a [mm]", "b [mm per decade]", "C", "C10")


def settlement(results, frequency=FREQUENCY):
    """Settlement [m] at the start of the last stage, which is zero, and after each whole cycle since then."""
    sleeper = results.tracks["sleeper"]
    first = int(np.flatnonzero(sleeper["stage"] == sleeper["stage"].max())[0])
    time, height = sleeper["time"][first - 1 :], sleeper["z" if "z" in sleeper else "y"][first - 1 :]
    cycles = int((time[-1] - time[0]) * frequency + 1e-6)
    return height[0] - np.interp(time[0] + np.arange(cycles + 1) / frequency, time, height)


def logarithmic_law(sunk):
    """Coefficients a and b [m] of s_N = a + b log10 N, and the share of the variance that the law explains."""
    number = np.unique(np.round(np.logspace(0, np.log10(len(sunk) - 1), 40)).astype(int))
    b, a = np.polyfit(np.log10(number), sunk[number], 1)
    left = sunk[number] - a - b * np.log10(number)
    return a, b, 1 - left.var() / sunk[number].var()


def coefficients(curves):
    """The coefficients NAMES of the mean curve of some samples."""
    a, b, _ = logarithmic_law(np.mean(curves, axis=0))
    return np.array([1e3 * a, 1e3 * b, b / a, b / (a + b)])


def bootstrap(curves, draws=DRAWS):
    """Coefficients of mean curves of as many samples, drawn with repetition: a row per draw."""
    random = np.random.default_rng(1)
    return np.array([coefficients(curves[random.integers(0, len(curves), len(curves))]) for _ in range(draws)])


def groups(folders):
    """Folders of results by group: the runs of each study, and what is named one by one."""
    found = {}
    for folder in map(Path, folders):
        runs = sorted(path.with_suffix("") for path in (folder / "runs").glob("*.json"))
        found.setdefault(folder.stem if runs else "samples", []).extend(runs or [folder])
    return found


def read_group(folders):
    """Settlement of each sample of a group, over the cycles that all have; a line per sample is printed."""
    curves = []
    for folder in folders:
        results = Results(folder)
        sunk = settlement(results)
        a, b, explained = logarithmic_law(sunk)
        curves.append(sunk)
        late = (sunk[-1] - sunk[len(sunk) // 2]) / (len(sunk) - 1 - len(sunk) // 2)
        print(f"{folder}: {len(sunk) - 1} cycles, s_1 {1e3 * sunk[1]:.2f} mm, last {1e3 * sunk[-1]:.2f} mm; a {1e3 * a:.2f} mm, "
              f"b {1e3 * b:.2f} mm per decade, C {b / a:.3f}, R2 {explained:.3f}; second half {1e6 * late:.2f} um per cycle; "
              f"volume error at most {100 * results.record['volume_error'].max():.3f} %")  # fmt: skip
    shortest = min(map(len, curves))
    return np.array([sunk[:shortest] for sunk in curves])


def print_law(name, curves):
    """Coefficients of the mean curve of a group with standard errors, and where 95 % of the bootstrap lie."""
    _, _, explained = logarithmic_law(curves.mean(axis=0))
    drawn = bootstrap(curves)
    print(f"{name}: mean curve of {curves.shape[1] - 1} cycles over {len(curves)} samples, R2 {explained:.3f}")
    spread = curves[:, [1, -1]].std(axis=0, ddof=min(1, len(curves) - 1))
    for label, values, deviation in zip(("s_1", "last"), curves[:, [1, -1]].T, spread):
        print(f"  {label}: {1e3 * values.mean():.2f} mm, standard deviation of samples {1e3 * deviation:.2f} mm")
    for label, value, error, low, high in zip(NAMES, coefficients(curves), drawn.std(axis=0), *np.percentile(drawn, (2.5, 97.5), axis=0)):
        print(f"  {label}: {value:.3f} +- {error:.3f}, 95 % within {low:.3f} to {high:.3f}")


def draw(ax, curves, colour, name):
    """Settlement of all samples, their mean with its standard error, and the law of the mean, against the number of cycles."""
    number = np.arange(1, curves.shape[1])
    ax.plot(number, 1e3 * curves[:, 1:].T, color=colour, linewidth=0.4, alpha=0.5)
    mean = curves.mean(axis=0)
    error = curves.std(axis=0, ddof=min(1, len(curves) - 1)) / np.sqrt(len(curves))
    a, b, _ = logarithmic_law(mean)
    ax.plot(number, 1e3 * mean[1:], color=colour, linewidth=2, label=f"{name}: mean of {len(curves)}")
    ax.fill_between(number, 1e3 * (mean - error)[1:], 1e3 * (mean + error)[1:], color=colour, alpha=0.2, linewidth=0)
    ax.plot(number, 1e3 * (a + b * np.log10(number)), color=colour, linestyle="--", linewidth=1)


def main(output, *folders):
    figure = new_figure(7, 4.5)
    ax = figure.subplots()
    for i, (name, results) in enumerate(groups(folders).items()):
        curves = read_group(results)
        print_law(name, curves)
        draw(ax, curves, f"C{i}", name)
    print(f"published C: {PUBLISHED[0]} to {PUBLISHED[1]}")
    ax.set(xscale="log", xlabel="load cycles N", ylabel="settlement [mm]")
    ax.invert_yaxis()
    ax.legend(title="band: standard error; dashed: a + b log10 N")
    figure.savefig(output, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
