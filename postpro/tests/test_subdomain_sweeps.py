"""The table of postpro/experiments/subdomain_sweeps.py, on numbers that are known."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "experiments"))
import subdomain_sweeps  # noqa: E402


def run_of(sweeps, steps, coordination):
    """A run whose coordination below sleeper 4 is that below sleeper 3 plus one, with a volume error of 1e-4 per step."""
    steps, coordination = np.array(steps, float), np.array(coordination)
    regions = {name: {"step": steps, "time": 1e-3 * steps, "volume_error": 1e-4 * steps, "coordination": coordination + shift}
               for name, shift in (("below.3", 0.0), ("below.4", 1.0))}  # fmt: skip
    return [sweeps] * 7, "warm", regions


def test_runs_are_compared_over_the_steps_that_all_have(capsys):
    """Steps 2 and 3 are common: means of 5 and 4 below sleeper 3, of 6 and 5 below sleeper 4; the largest error is that of step 3."""
    runs = [run_of(800, [1, 2, 3], [9.0, 4.0, 6.0]), run_of(100, [2, 3, 4], [4.0, 4.0, 9.0])]
    subdomain_sweeps.print_table(subdomain_sweeps.in_common(runs))
    rows = [line.split("|") for line in capsys.readouterr().out.splitlines()[1:]]
    assert [row[2].split() for row in rows] == [["5.00", "(+0.0)", "6.00", "(+0.0)"], ["4.00", "(-20.0)", "5.00", "(-16.7)"]]
    assert [row[1].split() for row in rows] == [["0.0300"] * 3] * 2
    assert [row[3].strip() for row in rows] == ["2", "2"]


def test_a_folder_is_a_study_or_a_run(tmp_path):
    (tmp_path / "s.study/runs").mkdir(parents=True)
    (tmp_path / "s.study/runs/a.json").write_text("{}")
    assert subdomain_sweeps.results_in(tmp_path / "s.study") == [tmp_path / "s.study/runs/a"]
    assert subdomain_sweeps.results_in(tmp_path / "one") == [tmp_path / "one"]
