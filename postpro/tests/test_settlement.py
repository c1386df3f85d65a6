"""The law of settlement that postpro/experiments/settlement.py takes from the track of a sleeper."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "experiments"))
import settlement  # noqa: E402

A, B, CYCLES = 5e-3, 1.5e-3, 200


@pytest.fixture
def results(tmp_path):
    """Tracks of a sleeper whose height follows a + b log10 N at the ends of cycles and swings between them."""
    number = np.arange(0, CYCLES * 5 + 1) / 5
    sunk = np.where(number > 0, A + B * np.log10(np.maximum(number, 1e-3)), 0) + 1e-3 * np.sin(np.pi * number) ** 2
    rows = [f"{i},{0.01 * i:.17g},4,sleeper,0.5" for i in range(1, 101)]  # 1 s at rest
    rows += [f"{101 + i},{1 + n / settlement.FREQUENCY:.17g},5,sleeper,{0.5 - s:.17g}" for i, (n, s) in enumerate(zip(number[1:], sunk[1:]))]
    (tmp_path / "tracks.csv").write_text("step,time,stage,body,y\n" + "\n".join(rows) + "\n")
    (tmp_path / "record.csv").write_text("step,time,volume_error\n1,0.01,1e-5\n")
    (tmp_path / "run.json").write_text("{}")
    return tmp_path


def test_a_known_law_is_recovered(results):
    sunk = settlement.settlement(settlement.Results(results))
    assert len(sunk) == CYCLES + 1 and sunk[0] == 0
    a, b, explained = settlement.logarithmic_law(sunk)
    # Heights and times are written with all their digits; what is lost is their rounding over that of the settlement.
    assert (a, b) == pytest.approx((A, B), rel=1e-9)
    assert explained == pytest.approx(1)


def test_coefficients_and_their_standard_errors_are_printed(results, capsys):
    settlement.main(results / "law.png", results, results)
    printed = capsys.readouterr().out
    assert re.search(r"200 cycles, s_1 5\.00 mm, last 8\.45 mm; a 5\.00 mm, b 1\.50 mm per decade, C 0\.300", printed)
    assert "samples: mean curve of 200 cycles over 2 samples, R2 1.000" in printed
    # The same sample twice: draws from the two do not differ.
    assert "C: 0.300 +- 0.000, 95 % within 0.300 to 0.300" in printed
    assert f"C10: {B / (A + B):.3f} +- 0.000" in printed
    assert (results / "law.png").stat().st_size > 1000


def test_the_bootstrap_has_the_standard_error_of_a_mean():
    """Curves of one law times random factors: b of their mean has the standard error of the mean factor, and C none at all."""
    factors = np.random.default_rng(5).lognormal(0, 0.5, 40)
    law = A + B * np.log10(np.maximum(np.arange(CYCLES + 1), 1))
    curves = factors[:, None] * law
    drawn = settlement.bootstrap(curves)
    a, b, c, _ = settlement.coefficients(curves)
    assert (a, b, c) == pytest.approx((1e3 * A * factors.mean(), 1e3 * B * factors.mean(), B / A), rel=1e-9)
    # The closed form of the bootstrap of a mean; 4000 draws give a standard deviation to 1.1 %, four of which are allowed.
    assert drawn[:, 1].std() == pytest.approx(1e3 * B * factors.std() / np.sqrt(40), rel=0.045)
    assert drawn[:, 2].std() < 1e-9


def test_runs_of_a_study_are_one_group(tmp_path):
    for name in ("a", "b"):
        (tmp_path / "light.study/runs" / name).mkdir(parents=True)
        (tmp_path / "light.study/runs" / f"{name}.json").write_text("{}")
    found = settlement.groups([tmp_path / "light.study", tmp_path / "one", tmp_path / "two"])
    assert {name: [folder.name for folder in folders] for name, folders in found.items()} == {"light": ["a", "b"], "samples": ["one", "two"]}
