"""Verdicts and thresholds: by hand, and through the real program where SPLITGRAIN_PROGRAM names one."""

import csv
import os
from pathlib import Path

import numpy as np
import pytest

from splitgrain_postpro.cli import main
from splitgrain_postpro.study.thresholds import sentence, sharpen
from splitgrain_postpro.study.verdict_file import VerdictReader, distance, middle
from splitgrain_postpro.study.verdicts import created, judge

DECKS = Path(__file__).resolve().parents[2] / "input_decks"
with_program = pytest.mark.skipif("SPLITGRAIN_PROGRAM" not in os.environ, reason="SPLITGRAIN_PROGRAM names no program to run")

# A block on a floor that has been given a speed slides farther than 1 m once its friction is below v^2 / (2 g).
SLIDES = f"""seconds = 20
[parameter]
name = "friction"
values = [0.01, 0.1, 1.0]
[threshold]
until = 0.02
[verdict]
penetration = 0.1
[[case]]
name = "block"
deck = "{DECKS / 'sliding_block.toml'}"
set = {{ "law.friction" = "{{mu}}", "time.step" = 1e-3, "time.steps" = 1500 }}
[[variant]]
name = "nlgs"
[[expect]]
name = "way"
value = "x_1"
is = "0.25"
within = "0.25"
[constants]
mu = "2 * p / 2"
"""
GOOD_RESULT = {"status": "done", "code": 0, "reason": "", "finite": True, "created": 1e-9, "ranges": {"kinetic_energy": [0.0, 2.0]},
               "numbers": {"steps": 10, "unconverged_steps": 0, "worst_penetration": 1e-6, "mean_radius": 0.1},
               "bodies": {"x_1": 0.3}}  # fmt: skip


def study_of(folder, text=SLIDES):
    path = folder / "study.toml"
    path.write_text(text)
    return VerdictReader(path).study()


class Point:
    """A job of which only the value counts."""

    def __init__(self, study, value):
        self.case, self.variant, self.value = study.cases[0], study.variants[0], value


def test_energy_that_appears_is_found_and_that_of_forces_is_not():
    record = {name: np.zeros(4) for name in ("external_work", "drive_work", "friction_loss", "impact_loss")}
    record |= {"kinetic_energy": np.array([4.0, 1.0, 3.0, 2.0]), "potential_energy": np.array([0.0, 3.0, 1.0, 2.0])}
    assert created(record) == 0.0
    record["kinetic_energy"][2] = 3.5  # from 4 J to 4.5 J, over a largest energy of 4 J
    assert created(record) == pytest.approx(0.125, abs=1e-15)
    record["external_work"][2:] = 0.5
    assert created(record) == 0.0
    # What was gained before the first row shows in losses below zero.
    record["impact_loss"][:] = -1.0
    assert created(record) == pytest.approx(0.25, abs=1e-15)


@pytest.mark.parametrize("change, why", [
    ({}, ""), ({"finite": False}, "not finite"), ({"created": 1e-3}, "energy created: 0.001"),
    ({"numbers": GOOD_RESULT["numbers"] | {"unconverged_steps": 1}}, "1 of 10 steps did not converge"),
    ({"numbers": GOOD_RESULT["numbers"] | {"worst_penetration": 0.02}}, "penetration 0.2 of the mean radius"),
    ({"bodies": {"x_1": 0.51}}, "way is 0.51, not 0.25 within 0.25"), ({"bodies": {"x_1": float("nan")}}, "way is nan"),
    ({"status": "not finite", "code": 4, "reason": "step 3"}, "not finite: step 3"),
    ({"status": "time limit", "code": None}, "time limit"),
])  # fmt: skip
def test_verdicts_by_hand(tmp_path, change, why):
    study = study_of(tmp_path)
    verdict = judge(study, Point(study, 0.1), GOOD_RESULT | change)
    assert verdict["held"] == (not why) and why in verdict["why"]


def test_the_exit_code_that_is_right_need_not_be_zero(tmp_path):
    study = study_of(tmp_path, SLIDES.replace("penetration = 0.1", "exit = [0, 2]"))
    assert judge(study, Point(study, 0.1), {"status": "refused", "code": 2, "reason": "centres coincide"})["held"]


def test_bisection_by_hand(tmp_path):
    study, asked = study_of(tmp_path), []

    def run(value):
        asked.append(value)
        return Point(study, value), GOOD_RESULT | {"bodies": {"x_1": 0.3 if value > 0.07 else 0.9}}

    points = [(*run(value), None) for value in study.values]
    points = sharpen(study, [(job, result, judge(study, job, result)) for job, result, _ in points], run)
    assert len(asked) - 3 == 6  # one decade halved until it is below 0.02
    edge = [(job.value, verdict["held"]) for job, _, verdict in points if 0.06 < job.value < 0.08]
    below, above = max(v for v, held in edge if not held), min(v for v, held in edge if held)
    assert below <= 0.07 < above and np.log10(above / below) <= 0.02
    assert f"holds at {above:.4g}" in sentence(study, points)


def test_scales():
    assert middle(1.0, 100.0, True) == 10.0 and middle(1.0, 100.0, False) == 50.5 and middle(0.0, 1.0, True) == 0.5
    assert distance(1.0, 100.0, True) == 2.0 and distance(0.0, 1.0, True) == 1.0


@pytest.mark.parametrize("old, new, line, sentence", [
    ("values = ", "value = ", 4, "unknown key 'value' of [parameter]; did you mean 'values'?"),
    ("[0.01, 0.1, 1.0]", "[]", 4, "'values' of [parameter] should be a list of numbers"),
    ("until = 0.02", "until = 0", 6, "'until' of [threshold] should be above 0"),
    ("penetration = 0.1", "exit = 3", 8, "'exit' of [verdict] should be a list"),
    ("is = \"0.25\"", "", 15, "[[expect]] needs 'is'"),
    ("is = ", "cases = ['stone']\nis = ", 18, "there is no case 'stone'"),
    ("{mu}", "{nu}", 12, "'nu' is unknown; there are"),
    ("set = ", "dump = 3\nset = ", 9, "verdicts are given on runs of decks"),
])  # fmt: skip
def test_mistakes_are_one_sentence_with_their_line(tmp_path, capsys, old, new, line, sentence):
    assert SLIDES.count(old) == 1
    path = tmp_path / "study.toml"
    path.write_text(SLIDES.replace(old, new))
    assert main(["study", str(path), "--program", os.environ.get("SPLITGRAIN_PROGRAM", "/bin/true"), "--output", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr().err
    if "SPLITGRAIN_PROGRAM" in os.environ:
        assert printed.startswith(f"{path}:{line}: error: ") and sentence in printed
    assert printed.count("\n") == 1


@with_program
def test_the_friction_at_which_a_block_slides_half_a_metre(tmp_path, capsys):
    """From 1 m/s it slides v^2 / (2 mu g): half a metre at mu = 0.10194; the second time nothing is run."""
    path, out = tmp_path / "study.toml", tmp_path / "out"
    path.write_text(SLIDES)
    for again in (False, True):
        assert main(["study", str(path), "--output", str(out)]) == 0
        printed = capsys.readouterr().out
        assert ("3 done before" in printed) == again and ("between" in printed) != again
    with open(out / "results.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    held = {float(row["value"]): row["held"] == "True" for row in rows}
    low, high = max(v for v, ok in held.items() if not ok), min(v for v, ok in held.items() if ok)
    # A friction is bracketed within 0.02 decades; the step moves the way by v h / 2 at most.
    assert low * 0.999 < 1 / (2 * 9.81 * 0.5) < high * 1.001 and np.log10(high / low) <= 0.02
    assert "does not hold up to" in printed and (out / "study.html").stat().st_size > 10000 and (out / "thresholds-1.png").exists()


def test_shipped_studies_are_right():
    paths = sorted((DECKS / "extreme").glob("*.toml"))
    assert len(paths) >= 14
    for path in paths:
        study = VerdictReader(path).study()
        assert study.title and study.about
