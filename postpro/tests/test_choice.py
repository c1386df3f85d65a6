"""Choices among settings: judged by hand, and runs that go on from states of their decks."""

import json
import math
import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from splitgrain_postpro.cli import main
from splitgrain_postpro.errors import ResultsError
from splitgrain_postpro.study.choice import Setting, choose, judge
from splitgrain_postpro.study.description import read_study
from splitgrain_postpro.study.jobs import jobs_of
from splitgrain_postpro.study.measures import errors_of, rms_of_bodies
from splitgrain_postpro.study.program import Program
from splitgrain_postpro.study.simulations import time_below

DECKS = Path(__file__).resolve().parents[2] / "input_decks"
PROGRAM = os.environ.get("SPLITGRAIN_PROGRAM")
with_program = pytest.mark.skipif(not PROGRAM, reason="SPLITGRAIN_PROGRAM names no program to run")

STUDY = f"""tolerances = [1e-1, 1e-2, 1e-5]
seconds = 10
[choice]
present = ["twenty", 1e-2]
[[measure]]
name = "position"
bodies = "position"
[[case]]
name = "arch"
deck = "{DECKS / 'arch_of_stones.toml'}"
from = 10
steps = 5
set = {{ "arch.voussoirs" = 7 }}
[[variant]]
name = "twenty"
set = {{ "solver.criterion" = "estimate" }}
[[variant]]
name = "one"
values = [1e-2]
set = {{ "solver.criterion" = "estimate", "solver.check_every" = 1 }}
"""
CHOICE = {"cases": 0.75, "worst": 10.0}


def written(folder, text):
    path = folder / "study.toml"
    path.write_text(text)
    return path


def test_judged_by_hand():
    settings = [
        Setting("fast but wrong", 1.0, [0.5, 2.0, 3.0, 0.1], [1.0] * 4),
        Setting("one far beyond", 1.0, [0.1, 0.1, 0.1, 11.0], [1.0] * 4),
        Setting("fit", 0.1, [0.1, 0.9, 1.0, 9.0], [1.0, 4.0, 2.0, 2.0]),
        Setting("fit and dearer", 0.1, [0.1, 0.1, 0.1, 0.1], [4.0, 4.0, 4.0, 4.0]),
        Setting("does not end", 0.1, [0.1, 0.1, 0.1, math.inf], [0.1, 0.1, 0.1, math.inf]),
    ]
    judge(settings, CHOICE)
    assert [s.is_fit for s in settings] == [False, False, True, True, False]
    assert [s.is_best for s in settings] == [False, False, True, False, False]
    # The geometric mean of 1, 4, 2, 2 is 2.
    assert [s.cost for s in settings] == pytest.approx([0.5, 0.5, 1.0, 2.0, math.inf])


def test_none_is_fit():
    settings = [Setting("a", 1.0, [2.0], [3.0]), Setting("b", 1.0, [3.0], [6.0])]
    judge(settings, CHOICE)
    assert not any(s.is_best for s in settings) and [s.cost for s in settings] == pytest.approx([1.0, 2.0])


def test_limits_by_hand(tmp_path):
    study = read_study(written(tmp_path, STUDY))

    def ended(x, seconds=1.0):
        return {"series": [[[0.1], [[x, 0.0, 0.0]]]], "mean_radius": 2.0, "cpu_seconds": seconds, "status": "done"}

    table = {("arch", "twenty", 1e-5): ended(1.0), ("arch", "time step / 4", 1e-5): ended(1.01), ("arch", "twenty", 1e-2): ended(1.0015),
             ("arch", "twenty", 1e-1): ended(1.006), ("arch", "one", 1e-2): ended(1.0, 5.0)}  # fmt: skip
    settings, limits = choose(study, table)
    # A third of the error of the time step is more than 1e-4 of the radius.
    assert limits["arch"] == pytest.approx((0.003, 0.01))
    assert [(s.variant, s.tolerance, *s.ratios) for s in settings] == [
        ("twenty", 0.1, pytest.approx(2.0)), ("twenty", 0.01, pytest.approx(0.5)), ("one", 0.01, 0.0)]  # fmt: skip
    assert [s.is_best for s in settings] == [False, True, False]
    table["arch", "time step / 4", 1e-5] = ended(1.0 + 1e-9)
    assert choose(study, table)[1]["arch"][0] == pytest.approx(2e-4)
    del table["arch", "time step / 4", 1e-5]
    assert choose(study, table)[1]["arch"] == (None, None)


def test_root_mean_square_of_bodies():
    assert rms_of_bodies(np.array([3.0, 4.0, 0.0, 0.0, 0.0, 0.0])) == pytest.approx(5 / math.sqrt(2))


def test_errors_against_the_first_variant(tmp_path):
    study = read_study(written(tmp_path, STUDY.replace('bodies = "position"', 'column = "compactness"\nagainst = "first"')))
    table = {("arch", name, tolerance): {"series": [[[0.1], [value]]]} for name, tolerance, value in
             (("twenty", 1e-1, 0.5), ("twenty", 1e-5, 0.8), ("one", 1e-2, 0.7))}  # fmt: skip
    errors = errors_of(study, table, 0)
    assert errors["arch", "twenty"] == [(0.1, pytest.approx(0.3))] and errors["arch", "one"] == [(0.01, pytest.approx(0.1))]


def test_time_from_which_a_column_stays_below():
    record = {"time": np.array([1.0, 2.0, 3.0, 4.0]), "speed": np.array([0.5, 0.0, 0.5, 0.0])}
    assert time_below(record, "speed", 0.1) == 4.0 and time_below(record, "speed", 1.0) == 1.0
    assert time_below(record | {"speed": np.array([0.5, 0.05, 0.01, 0.0])}, "speed", 0.1) == 2.0
    assert time_below(record | {"speed": np.full(4, np.nan)}, "speed", 0.1) == 4.0
    with pytest.raises(ResultsError):
        time_below(record, "force", 0.1)


@pytest.mark.parametrize("old, new, line, sentence", [
    ("steps = 5\n", "", 11, "'from' of [case] is a time step"),
    ("from = 10", "from = -1", 11, "'from' of [case] is a time step"),
    ('bodies = "position"', 'bodies = "weight"', 7, "'bodies' of [measure] should be position or velocity"),
    ('bodies = "position"', 'bodies = "position"\nover = "mean"', 8, "'over' is not for measures of all bodies"),
    ('bodies = "position"', 'body = 1\nbelow = 1.0', 8, "'below' of [measure] needs a column"),
    ('bodies = "position"', 'bodies = "position"\nagainst = "all"', 8, "'against' of [measure] should be own or first"),
    ("[choice]", "[choice]\nshare = 0", 4, "'share' of [choice] should be above 0"),
    ("[choice]", "[choice]\nmeasure = 'weight'", 4, "there is no measure 'weight'"),
    ('["twenty", 1e-2]', '["thirty", 1e-2]', 4, "'present' of [choice] should be"),
    ("values = [1e-2]", "values = [1e-3]", 19, "'values' of [variant] should be some of those that are varied"),
    ("values = [1e-2]", "parts = 0", 19, "'parts' of [variant] should be above 0"),
    ("tolerances = [1e-1, 1e-2, 1e-5]", "subdomains = [1, 2]", 3, "a choice is made among runs at several tolerances"),
])  # fmt: skip
def test_mistakes(tmp_path, capsys, old, new, line, sentence):
    assert STUDY.count(old) == 1
    path = written(tmp_path, STUDY.replace(old, new).replace("values = [1e-2]", "" if "subdomains" in new else "values = [1e-2]"))
    assert main(["study", str(path), "--output", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr().err
    assert printed.startswith(f"{path}:{line}: error: ") and sentence in printed


def test_only_what_the_choice_needs_is_run(tmp_path):
    jobs = jobs_of(read_study(written(tmp_path, STUDY)), "p")
    assert [(job.variant.name, job.value) for job in jobs] == [
        ("twenty", 1e-1), ("twenty", 1e-2), ("twenty", 1e-5), ("one", 1e-2), ("time step / 4", 1e-5)]  # fmt: skip
    finer = jobs[-1].settings
    assert (finer["time.step"], finer["time.steps"]) == (pytest.approx(2.5e-4), 10 + 4 * 5)


@with_program
def test_a_state_goes_on_as_the_straight_run(tmp_path, capsys, render_only):
    render_only()
    text = STUDY.replace("[choice]\npresent = [\"twenty\", 1e-2]\n", "")
    straight = SimpleNamespace(text=text.replace("from = 10\nsteps = 5", "steps = 15"), place=tmp_path / "straight")
    goes_on = SimpleNamespace(text=text, place=tmp_path / "goes on")
    found = []
    for run in (straight, goes_on):
        # Until the state the deck's own settings hold: the tolerance that is varied is that of the deck.
        text = run.text.replace("[1e-1, 1e-2, 1e-5]", "[1e-4]").replace('"solver.criterion" = "estimate"', '"solver.criterion" = "e8"')
        path = written(tmp_path, text.replace("values = [1e-2]\n", ""))
        assert main(["study", str(path), "--output", str(run.place)]) == 0
        study = read_study(path)
        found.append([(run.place / "runs" / f"{job.key}.json").read_text() for job in jobs_of(study, Program().digest)])
    # The first variant has the deck's settings, also those that it is silent about.
    one, other = (json.loads(texts[0]) for texts in found)
    assert one["series"] == other["series"] and (one["steps"], other["steps"]) == (15, 5)
    assert 0 < other["sweeps"] < one["sweeps"]
    assert main(["study", str(path), "--output", str(goes_on.place)]) == 0
    assert "0 of 2 runs to do" in capsys.readouterr().out


@with_program
def test_a_choice_is_reported(tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["study", str(written(tmp_path, STUDY)), "--output", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "5 of 5 runs to do" in printed and "\npresent: twenty to 0.01, " in printed and "\nbest: " in printed
    assert (out / "choice.png").exists() and "Choice" in (out / "study.html").read_text()
    assert len(list((out / "states").iterdir())) == 1
