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


def test_coefficients_and_their_spread_are_printed(results, capsys):
    settlement.main(results / "law.png", results, results)
    printed = capsys.readouterr().out
    assert re.search(r"200 cycles, s_1 5\.00 mm, last 8\.45 mm; a 5\.00 mm, b 1\.50 mm per decade, C 0\.300", printed)
    assert "C: 0.300 +- 0.000 over 2 samples" in printed
    assert "mean curve of 200 cycles: a 5.00 mm, b 1.50 mm per decade, C 0.300, R2 1.000" in printed
    assert (results / "law.png").stat().st_size > 1000
