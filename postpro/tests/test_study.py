"""Studies: their files, their numbers by hand, and whole studies through the real program where SPLITGRAIN_PROGRAM names one."""

import csv
import io
import json
import math
import os
import random
import re
import shutil
import signal
import subprocess
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from splitgrain_postpro.cli import main
from splitgrain_postpro.study.vary_study import VaryReader
from splitgrain_postpro.errors import StudyError
from splitgrain_postpro.study.csv_text import csv_text
from splitgrain_postpro.study.deck_titles import deck_section
from splitgrain_postpro.study.description import read_study
from splitgrain_postpro.study.drawings import comparison, convergence, profiles, traces, work_precision
from splitgrain_postpro.study.expressions import evaluate
from splitgrain_postpro.study.jobs import jobs_of
from splitgrain_postpro.study.measures import efforts_to_levels, order_of
from splitgrain_postpro.study.model import Case
from splitgrain_postpro.study.problems import distance
from splitgrain_postpro.study.profiles import profile, share, times_of
from splitgrain_postpro.study.program import Program
from splitgrain_postpro.study.svg import embedded, is_cut_off
from splitgrain_postpro.study.threads import do_all, threads_of
from splitgrain_postpro.study.toml_lines import line_of
from splitgrain_postpro.style import styled

DECKS = Path(__file__).resolve().parents[2] / "input_decks"
PROGRAM = os.environ.get("SPLITGRAIN_PROGRAM")
with_program = pytest.mark.skipif(not PROGRAM, reason="SPLITGRAIN_PROGRAM names no program to run")

# Studies of the talk.
TALK = ("network", "shear_methods", "reasonable")
BOUNCES = f"""time_steps = [1e-2, 1e-3, 1e-4]
duration = 0.75
[constants]
g = 9.81
v = "sqrt(2 * g * 0.5)"
t1 = "v / g"
[[case]]
name = "ball"
deck = "{DECKS / 'bouncing_ball.toml'}"
[[variant]]
name = "mid-point"
[[measure]]
name = "height"
body = 1
component = "y"
over = "mean"
closed_form = '''0.1 + (0.5 - g * t**2 / 2 if t < t1 else v / 2 * (t - t1) - g * (t - t1)**2 / 2 if t < 2 * t1
                 else v / 4 * (t - 2 * t1) - g * (t - 2 * t1)**2 / 2)'''
"""
# The same by a number of the end: no picture is written and read.
ENDS = re.sub(r'name = "height".*', 'column = "kinetic_energy"\nclosed_form = "0"\n', BOUNCES, flags=re.S)
STONES = f"""tolerances = [1e-2, 1e-6]
seconds = 20
[reference]
tolerance = 1e-11
[[case]]
name = "arch"
deck = "{DECKS / 'arch_of_stones.toml'}"
dump = 5
set = {{ "arch.voussoirs" = 7 }}
[[variant]]
solver = "interior"
[[variant]]
name = "one sweep"
solver = "nlgs"
iterations = 1
"""
# A study that is right, to be spoiled.
GOOD = f"""tolerances = [1e-3]
repeats = 1
[[case]]
deck = "{DECKS / 'sliding_block.toml'}"
[[variant]]
name = "plain"
set = {{ "solver.order" = "natural" }}
[[measure]]
column = "kinetic_energy"
"""


def written(folder, text, name="study.toml"):
    path = folder / name
    path.write_text(text)
    return path


def done(folder, path, *words):
    """Run a study by the package; its exit code and the folder of its results."""
    return main(["study", str(path), "--output", str(folder / "out"), *words]), folder / "out"


def rows_of(out):
    with open(out / "results.csv", newline="") as file:
        return list(csv.DictReader(file))


def stamps(out):
    """When each result was written."""
    return {path.name: path.stat().st_mtime_ns for path in (out / "runs").iterdir()}


def test_profile_by_hand():
    inf = math.inf
    times = {"a": {1: 1.0, 2: 4.0, 3: inf, 4: inf}, "b": {1: 2.0, 2: 1.0, 3: 3.0, 4: inf}, "c": {1: 1.0, 2: 40.0, 3: 6.0, 4: inf}}
    ratios, count = profile(times)
    assert count == 4 and ratios == {"a": [1.0, 4.0], "b": [1.0, 1.0, 2.0], "c": [1.0, 2.0, 40.0]}
    assert [share(ratios["a"], count, tau) for tau in (1, 3.9, 4, inf)] == [0.25, 0.25, 0.5, 0.5]
    assert [share(ratios["b"], count, tau) for tau in (1, 2)] == [0.5, 0.75]
    assert share(ratios["c"], count, inf) == 0.75


def test_unsolved_is_infinite_whatever_the_solver_says(tmp_path):
    study = read_study(written(tmp_path, STONES))
    result = {"cpu_seconds": 2.0, "e1": 1e-7}
    table = {("arch", "interior", 1e-6): result | {"status": "solved"}, ("arch", "one sweep", 1e-6): result | {"status": "time limit"}}
    assert times_of(study, table, 1e-6) == {"interior": {"arch": 2.0}, "one sweep": {"arch": math.inf}}
    table["arch", "interior", 1e-6]["e1"] = 2e-6
    assert times_of(study, table, 1e-6)["interior"] == {"arch": math.inf}


def test_order_by_hand():
    assert order_of([(0.1, 0.3), (0.01, 0.03), (0.001, 0.003)]) == pytest.approx(1.0, abs=1e-12)
    assert order_of([(0.4, 1.6), (0.2, 0.4), (0.1, 0.1)]) == pytest.approx(2.0, abs=1e-12)
    assert order_of([(0.1, 0.0), (0.01, 0.1)]) is None


def test_distance_is_the_energy_norm_of_velocities():
    w = np.array([[2.0, 1.0], [1.0, 3.0]])
    q, r, other = np.array([-1.0, -2.0]), np.array([1.0, 2.0]), np.array([1.5, 1.0])
    reference, answer = {"r": r, "u": w @ r + q, "q": q}, {"r": other, "u": w @ other + q}
    assert distance(answer, reference) == pytest.approx(math.sqrt((other - r) @ w @ (other - r) / (r @ w @ r)), rel=1e-14)
    assert distance(answer, None) is None and distance({}, reference) is None


@pytest.mark.parametrize("text, value", [
    ("2 * x**2 - 1", 17.0), ("x if x < 2 else -x", -3.0), ("max(1, sqrt(4 * x - 3))", 3.0), ("-sin(pi / 2) + x % 2", 0.0),
])  # fmt: skip
def test_expressions(text, value):
    assert evaluate(text, {"x": 3.0}) == pytest.approx(value, abs=1e-15)


@pytest.mark.parametrize("text", ["y", "1 / 0", "sqrt(-1)", "open('x')", "x.real", "__import__('os')", "1 +", "[1]", "'a'", "sqrt(1, 2)",
                                  "9.0**9999", "1j * x", "9**9**9**9", "-9**99999", "(-8) ** 0.5", "1" * 3000, "(" * 300, "-" * 1500 + "1",
                                  "x * (" * 90 + "x" + ")" * 90 + "+", "2**x**x**x**x**x", "\0"])  # fmt: skip
def test_expressions_that_are_none(text):
    with pytest.raises(ValueError):
        evaluate(text, {"x": 3.0})


def test_random_expressions_end_soon():
    """Any expression has a value or a ValueError, within a time that does not depend on its numbers."""
    rng = random.Random(14)

    def expression(depth):
        if depth == 0 or rng.random() < 0.2:
            return rng.choice(["x", "9", "99999999", "1e300", "0", "-1", "0.5", "pi", "9" * 400])
        way = rng.randrange(4)
        if way == 0:
            return f"({expression(depth - 1)})**({expression(depth - 1)})"
        if way == 1:
            return f"{rng.choice(['exp', 'floor', 'sqrt', 'abs', 'log', 'ceil'])}({expression(depth - 1)})"
        if way == 2:
            return f"({expression(depth - 1)} if {expression(depth - 1)} < {expression(depth - 1)} else {expression(depth - 1)})"
        return f"({expression(depth - 1)} {rng.choice(['+', '-', '*', '/', '%', '**'])} {expression(depth - 1)})"

    values = 0
    began = time.process_time()
    for _ in range(500):
        try:
            values += isinstance(evaluate(expression(5), {"x": 3.0}), float)
        except ValueError:
            pass
    assert values > 50
    # 500 expressions of some ten operations: well below a second, where a single power of integers may take for ever.
    assert time.process_time() - began < 5


def test_titles_of_decks_are_on_the_page(tmp_path):
    decks = {"a.toml": "title = 'A <b>'\nabout = 'why & how'\n[time]\n", "b.toml": "[time]\n", "c.toml": "title = ", "d.toml": "title = 3\n"}
    for name, text in decks.items():
        (tmp_path / name).write_text(text)
    cases = [Case(str(number), tmp_path / name) for number, name in enumerate([*decks, "a.toml", "nowhere.toml", "p.hdf5"])]
    (heading, _, html), = deck_section(cases)
    assert heading == "Decks" and html == "<ul><li>a.toml: <b>A &lt;b&gt;</b>: why &amp; how</li></ul>"
    assert deck_section(cases[1:4]) == []


def test_cells_are_no_formulas():
    rows = [["name", "value"], ["=1+1", -1.5], ["@x", 2], ["-cmd|' /C calc'!A0", None], ["+a", float("nan")], ["plain, text", True], ["\ttab", ""]]
    cells = list(csv.reader(io.StringIO(csv_text(rows))))
    assert [row[0] for row in cells] == ["name", "'=1+1", "'@x", "'-cmd|' /C calc'!A0", "'+a", "plain, text", "'\ttab"]
    assert [row[1] for row in cells] == ["value", "-1.5", "2", "", "nan", "True", ""]


@pytest.mark.parametrize("old, new, line, sentence", [
    ("repeats = 1", "repeat = 1", 2, "unknown key 'repeat'; did you mean 'repeats'?"),
    ("repeats = 1", "repeats = 0", 2, "'repeats' should be above 0"),
    ("repeats = 1", "repeats = 1.5", 2, "'repeats' should be a whole number"),
    ("repeats = 1", "repeats = true", 2, "'repeats' should be a whole number"),
    ("repeats = 1", "jobs = 'some'", 2, "'jobs' should be a whole number above 0, or \"all\""),
    ("repeats = 1", "seconds = nan", 2, "'seconds' should be above 0"),
    ("repeats = 1", "time_steps = [1e-3]", 2, "needs one of tolerances, time_steps, subdomains, not tolerances and time_steps"),
    ("repeats = 1", "repeats = ", 2, "invalid value"),
    ("tolerances = [1e-3]", "", 1, "needs one of tolerances, time_steps, subdomains"),
    ("[1e-3]", "[-1.0]", 1, "'tolerances' should be a list of numbers above 0"),
    ("[1e-3]", "[]", 1, "'tolerances' should be a list of numbers above 0"),
    ("tolerances = [1e-3]", "subdomains = [1.5]", 1, "'subdomains' should be a list of whole numbers above 0"),
    ("tolerances = [1e-3]", "time_steps = [1e-3]", 1, "needs its 'duration'"),
    ("tolerances = [1e-3]", "duration = 1\ntime_steps = [0.3]", 2, "no whole number of time steps"),
    ("sliding_block", "sliding_rock", 4, "there is no deck"),
    ("[[case]]\n", "[[case]]\nfiles = '*.hdf5'\n", 4, "either a deck or files"),
    ("deck = ", "files = 'none-*.hdf5' # ", 4, "the contact problems that it needs are not there"),
    ("deck = ", "dump = 0\ndeck = ", 4, "'dump' of [case] should be a time step"),
    ("[[case]]", "[case]", 3, "'case' should be a list"),
    ("name = \"plain\"", "name = 3", 6, "'name' of [variant] should be a text"),
    ("name = \"plain\"", "solver = 'nlgs'", 6, "'solver' belongs to variants of contact problems"),
    ("[[variant]]", "[[variant]]\nname = 'plain'\n[[variant]]", 8, "two of [[variant]] are named 'plain'"),
    ("{ \"solver.order\" = ", "{ solver.order = ", 7, "a setting is written \"section.key\" = value"),
    ("column = ", "over = 'always'\ncolumn = ", 9, "'over' of [measure] should be end, mean, largest"),
    ("column = ", "closed_form = 't + y'\ncolumn = ", 9, "'y' is unknown; there are pi, t"),
    ("column = ", "body = 1\ncolumn = ", 8, "either a column of record.csv, or a body, or bodies"),
])  # fmt: skip
def test_mistakes_are_one_sentence_with_their_line(tmp_path, capsys, old, new, line, sentence):
    assert GOOD.count(old) == 1
    path = written(tmp_path, GOOD.replace(old, new))
    assert main(["study", str(path), "--output", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr()
    assert printed.err.startswith(f"{path}:{line}: error: ") and sentence in printed.err
    assert printed.err.count("\n") == 1 and not (tmp_path / "out").exists()


def test_mistakes_outside_the_file(tmp_path, capsys, monkeypatch):
    good = written(tmp_path, GOOD)
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe")
    monkeypatch.setenv("SPLITGRAIN_PROGRAM", "/bin/true")
    for words, message in (
        ([tmp_path / "none.toml"], "No such file"), ([binary], "no text in UTF-8"), ([good, "--jobs", "0"], "--jobs needs"),
        ([good, "--program", "no-such-program"], "there is no program no-such-program"), ([good], "is no splitgrain"),
    ):  # fmt: skip
        assert main(["study", *map(str, words), "--output", str(tmp_path / "out")]) == 2
        printed = capsys.readouterr().err
        assert message in printed and printed.count("\n") == 1


def test_lines_of_keys():
    text = 'a = 1\n[[x]]\nb = 2\n\n[[x]] # second\n"b" = 3\n[y.z]\nc = 4\n'
    assert [line_of(text, *place) for place in (("", 1, "a"), ("x", 1, "b"), ("x", 2, "b"), ("x", 2, "c"), ("y.z", 1, "c"))] == \
        [1, 3, 6, 5, 8]


def test_keys_tell_work_apart_and_not_names(tmp_path):
    deck = tmp_path / "deck.toml"
    shutil.copy(DECKS / "sliding_block.toml", deck)
    text = GOOD.replace(str(DECKS / "sliding_block.toml"), str(deck))

    def key(text, program="p"):
        return jobs_of(read_study(written(tmp_path, text)), program)[0].key

    first = key(text)
    assert key(text.replace('"plain"', '"simple"')) == first
    assert first not in (key(text, "other"), key(text.replace("natural", "groups")), key(text.replace("1e-3", "1e-4")))
    deck.write_text(deck.read_text().replace("2500.0", "2600.0"))
    assert key(text) != first
    # A file that the deck names is part of the work.
    deck.write_text(deck.read_text() + '[[body]]\nfile = "part.stl"\n')
    (tmp_path / "part.stl").write_text("one")
    before = key(text)
    (tmp_path / "part.stl").write_text("two")
    assert key(text) != before


VARIED = {"friction_of_blocks": 2, "rolling_friction": 1, "subdomain_sweeps": 1, "subdomain_sweeps_few": 2, "settlement": 1,
          "settlement_in_space": 1, "sweeps_needed": 1, "tamping_speeds": 1}
"""Keys that shipped studies of any key vary"""


def test_shipped_studies_are_right():
    paths = [*sorted((DECKS / "studies").glob("*.toml")), *(DECKS / "talk" / f"{name}.toml" for name in TALK)]
    assert len(paths) >= 3
    for path in paths:
        if "[[vary]]" in path.read_text():
            assert len(VaryReader(path).read()["vary"]) == VARIED[path.stem]
        elif path.name == "solvers_of_others.toml":
            try:
                assert len(read_study(path).cases) > 1
            except StudyError as error:
                assert "the contact problems that it needs are not there" in str(error) and error.line > 0
        else:
            assert read_study(path).cases


@pytest.fixture(scope="module")
def bounced(tmp_path_factory):
    """A study of time steps that is done: what it printed, and its folder."""
    place = tmp_path_factory.mktemp("bounced")
    words = [PROGRAM, "study", str(written(place, BOUNCES)), "--output", str(place / "out")]
    study = subprocess.run(words, capture_output=True, text=True, timeout=300)
    assert study.returncode == 0, study.stderr
    return study.stdout, place / "out"


@with_program
def test_order_one_across_impacts(bounced):
    printed, out = bounced
    # The error of one run depends on where in a step the impacts fall: the slope of three is no better than this.
    assert 0.7 < float(re.search(r"error of height is of order (\S+) in the time step", printed)[1]) < 1.3
    errors = [float(row["error of height"]) for row in rows_of(out)]
    assert errors == sorted(errors, reverse=True) and 0 < errors[-1] < 1e-3


@with_program
def test_resuming(tmp_path, capsys, render_only):
    render_only()
    path = written(tmp_path, ENDS)
    code, out = done(tmp_path, path)
    errors = [row["error of kinetic_energy"] for row in rows_of(out)]
    before = stamps(out)
    assert code == 0 and len(before) == 3 and all(name.endswith(".json") for name in before) and len({*errors} - {""}) == 3
    # One result is gone, one is cut: these two are done again and no other.
    lost, cut, kept = sorted(before)
    (out / "runs" / lost).unlink()
    (out / "runs" / cut).write_text((out / "runs" / cut).read_text()[:40])
    capsys.readouterr()
    assert done(tmp_path, path)[0] == 0
    assert "2 of 3 runs to do, 1 done before" in capsys.readouterr().out
    after = stamps(out)
    assert after.keys() == before.keys() and after[kept] == before[kept] and after[cut] != before[cut]
    assert [row["error of kinetic_energy"] for row in rows_of(out)] == errors
    # One more time step: the others are not run again.
    assert done(tmp_path, written(tmp_path, ENDS.replace("[1e-2,", "[1e-2, 5e-3,")))[0] == 0
    assert "1 of 4 runs to do, 3 done before" in capsys.readouterr().out


@with_program
def test_page_stands_alone(bounced):
    out = bounced[1]
    text = (out / "study.html").read_text()
    pictures = list(out.glob("*.png"))
    assert text.count("<svg") == len(pictures) >= 2 and "<img" not in text
    assert not re.search(r"<script[^>]|https?:|src=|<link(?! rel=\"icon\" href=\"data:,\")", text)
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in pictures)
    assert not [path for path in out.rglob(".*")]


@with_program
def test_against_the_smallest_step(bounced, tmp_path, capsys):
    shutil.copytree(bounced[1], tmp_path / "out")
    text = re.sub(r"closed_form = '''.*'''\n", "", BOUNCES, flags=re.S)
    code, out = done(tmp_path, written(tmp_path, text))
    assert "0 of 3 runs to do" in capsys.readouterr().out
    errors = [row["error of height"] for row in rows_of(out)]
    assert code == 0 and errors[-1] == "" and float(errors[0]) > float(errors[1]) > 0


@with_program
def test_contact_problems(tmp_path, capsys, render_only, unarranged):
    render_only("case-1-distance", "case-1-trace")
    if not re.search(r"^HDF5\s+on", subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout, re.M):
        pytest.skip("the program is built without HDF5")
    code, out = done(tmp_path, written(tmp_path, STONES), "--jobs", "all")
    printed = capsys.readouterr().out
    rows = rows_of(out)
    assert code == 0 and len(rows) == 6 and "e1 <= 1e-06: interior         fastest 100 %" in printed
    assert {path.name for path in out.glob("*.png")} == {"case-1-distance.png", "case-1-trace.png"}
    for row in rows:
        assert row["status"] == ("solved" if float(row["e1"]) <= float(row["value"]) else "not solved")
    near = [float(row["distance"]) for row in rows if row["variant"] == "interior" and row["repeat"] == "1"]
    far = [float(row["distance"]) for row in rows if row["variant"] == "one sweep"]
    assert near[1] < near[0] and near[1] < 1e-3 < min(far)
    assert {row["status"] for row in rows if row["variant"] == "one sweep" and float(row["value"]) < 1e-3} == {"not solved"}
    traces = [json.loads(path.read_text()).get("trace") for path in (out / "runs").iterdir()]
    assert sum(bool(trace) for trace in traces) == 2
    capsys.readouterr()
    assert done(tmp_path, written(tmp_path, STONES))[0] == 0
    assert "0 of 6 runs to do" in capsys.readouterr().out


@with_program
def test_stopped_and_gone_on(tmp_path, capsys, render_only):
    render_only()
    # The last run alone takes far longer than the others: it is under way when the study is stopped.
    path = written(tmp_path, ENDS.replace("[1e-2, 1e-3, 1e-4]", "[1e-2, 1e-3, 1e-8]"))
    words = [PROGRAM, "study", str(path), "--output", str(tmp_path / "out")]
    study = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + 300
    while len(list((tmp_path / "out" / "runs").glob("*.json"))) < 2 and time.monotonic() < end and study.poll() is None:
        time.sleep(0.05)
    study.send_signal(signal.SIGTERM)
    _, message = study.communicate(timeout=60)
    assert study.returncode == 75 and "the same command goes on" in message and message.count("\n") == 1
    runs = list((tmp_path / "out" / "runs").iterdir())
    assert len(runs) == 2 and all(json.loads(run.read_text())["status"] == "done" for run in runs)
    # A last run that ends: of its own results and of those before.
    code, out = done(tmp_path, written(tmp_path, ENDS.replace("[1e-2, 1e-3, 1e-4]", "[1e-2, 1e-3, 5e-4]")))
    assert code == 0 and "1 of 3 runs to do, 2 done before" in capsys.readouterr().out and len(rows_of(out)) == 3


@with_program
def test_term_while_runs_are_waited_for(tmp_path):
    # A run of many million steps on each thread. The signal ends them, and with them the wait; nothing runs after that.
    program = Program(PROGRAM)
    threading.Timer(1, os.kill, (os.getpid(), signal.SIGTERM)).start()
    with pytest.raises(KeyboardInterrupt), threads_of(program, 2) as pool:
        many = ["--set", "time.step=1e-8", "--set", "time.steps=75000000", "--set", "output.every=0"]
        deck = DECKS / "bouncing_ball.toml"
        do_all(pool, lambda name: program.call(["run", deck, "--quiet", "--output", tmp_path / name, *many], 600), "ab")
    assert not program.running
    with pytest.raises(InterruptedError):
        program.call(["--version"], 10)


@with_program
def test_limit_of_time(tmp_path, render_only):
    render_only()
    code, out = done(tmp_path, written(tmp_path, "seconds = 1\n" + ENDS.replace("[1e-2, 1e-3, 1e-4]", "[1e-2, 1e-8]")))
    assert code == 0 and [row["status"] for row in rows_of(out)] == ["done", "time limit"]


@with_program
def test_subdomains(tmp_path, render_only):
    render_only("case-1-e1-bytes", "case-1-subdomains-bytes")
    deck = DECKS / "decomposition" / "packing.toml"
    text = f"""subdomains = [1, 2]
[[case]]
deck = "{deck}"
[[variant]]
name = "dual"
set = {{ "time.steps" = 5, "output.every" = 0 }}
[[measure]]
column = "kinetic_energy"
"""
    code, out = done(tmp_path, written(tmp_path, text))
    one, two = rows_of(out)
    assert code == 0 and one["bytes"] == "" and float(two["bytes"]) > 0
    assert one["error of kinetic_energy"] == "" and float(two["error of kinetic_energy"]) >= 0


@with_program
def test_network_of_the_talk(tmp_path, render_only, unarranged):
    """A small one: states by the deck's own law, then one cold step by another law, traced; linear interactions converge by every
    method, and on four subdomains to the same answer."""
    render_only("case-1-history-*", "case-1-effort-*")
    small = """set = { "sample.count" = 150, "sample.box" = [0.0, 0.0, 0.25, 1.0], "wall[3].from" = [0.35, -0.2],
"wall[3].to" = [0.35, 3.5]"""
    text = (DECKS / "talk" / "network.toml").read_text()
    text = re.sub(r"subdomains = .*", "subdomains = [1, 4]", text).replace('"network_packing', f'"{DECKS}/talk/network_packing')
    small = small.replace("\n", " ")
    text = text.replace('set = { "law[1]', small + ', "law[1]').replace("from = 1000", "from = 300")
    text = text.replace("steps = 1\nthen", f"steps = 1\n{small} }}\nthen")
    text += '[[measure]]\nbodies = "velocity"\nagainst = "first"\n'
    # Two of the four interactions, three of the methods.
    left_out = [f'name = "{name}' for name in ("linear, epsilon_0", "frictionless", "primal", "exchange")]
    head, *blocks = text.split("[[")
    text = "[[".join([head, *(block for block in blocks if not any(name in block for name in left_out))])
    code, out = done(tmp_path, written(tmp_path, text))
    assert code == 0
    rows = [row for row in rows_of(out) if row["case"].startswith("linear")]
    assert len(rows) == 6 and all(float(row["e8"]) < 1e-8 for row in rows)
    assert all(float(row["error of velocity of bodies"] or 0) < 1e-6 for row in rows)
    with open(out / "histories.csv", newline="") as file:
        starts = [row for row in csv.DictReader(file) if row["iteration"] == "0"]
    assert len(starts) == 12 and all(float(row["e8"]) == 1.0 for row in starts)
    assert len(list(out.glob("case-1-history-*.png"))) == 6 and len(list(out.glob("case-1-effort-*.png"))) == 2
    with pytest.raises(StudyError, match="settings of runs that go on"):
        read_study(written(tmp_path, re.sub("from = .*\nsteps.*", "", text)))


def test_efforts_to_levels_by_hand():
    """The first point at or below each level counts, though the error rises again; levels that are not reached have no row."""
    names = ("iteration", "cpu_seconds", "e8", "messages", "bytes", "collectives")
    points = [dict(zip(names, point, strict=True)) for point in
              [(0, 0.5, 1.0, 0, 0, 1), (1, 1.0, 0.01, 10, 80, 2), (2, 2.0, 0.2, 20, 160, 3), (3, 3.0, 0.004, 30, 240, 4)]]  # fmt: skip
    assert efforts_to_levels(points, 4) == [[0.1, 1, 1.0, 10 + 6 * 2, 80], [0.01, 1, 1.0, 22, 80]]
    assert efforts_to_levels(points, 1)[0][3] == 10 and efforts_to_levels([], 4) == []


def test_nothing_of_a_figure_is_cut_off():
    """Texts of figures stay within them, also where names are long; a figure in which they do not is noticed."""
    long = "a variant whose name is a sentence that does not fit into any one line of a legend"
    study = read_study(DECKS / "studies" / "time_steps.toml")
    study = replace(study, variants=[replace(study.variants[0], name=f"{long} {k}") for k in range(7)])
    curves = {variant.name: [(1e-3, 1e-2), (1e-2, 1e-1)] for variant in study.variants}
    label = "error of the mean height of all bodies that have been dropped so far, over their radius [-]"
    with styled():
        figures = [convergence(study, curves, {}, label, long * 2), traces(study, {name: [(1, 1, 1), (2, 2, 2)] for name in curves}, long),
                   work_precision(study, study.cases[0], {name: [(1, 0.1, True), (2, 0.01, False)] for name in curves}, "cpu_seconds", label, long),
                   profiles(study, {name: [1.0, 2.0] for name in curves}, 3, long * 2)]  # fmt: skip
        assert [is_cut_off(figure) for figure in figures] == [False] * 4
        figures[0].text(0.9, 0.5, long)
        assert is_cut_off(figures[0])


@pytest.mark.parametrize("low, high", [(0.27, 0.38), (1.01, 1.2), (0.3, 3), (4e-3, 7e-3), (1, 1e5)])
def test_axes_of_work_have_numbers(low, high):
    """At least two ticks within an axis of work have numbers, however little of a decade it spans."""
    study = read_study(DECKS / "studies" / "time_steps.toml")
    curves = {study.variants[0].name: [(low, 0.1, True), (high, 0.01, True)]}
    with styled():
        figure = work_precision(study, study.cases[0], curves, "cpu_seconds", "error [-]", "a title")
        figure.draw_without_rendering()
        axis = figure.axes[0].xaxis
        ends = figure.axes[0].get_xlim()
        labelled = [tick for minor in (False, True) for tick in (axis.get_minor_ticks() if minor else axis.get_major_ticks())
                    if tick.label1.get_text() and ends[0] <= tick.get_loc() <= ends[1]]  # fmt: skip
        assert len(labelled) >= 2


def test_lines_of_a_figure_are_series_of_the_page():
    study = read_study(DECKS / "studies" / "time_steps.toml")
    curves = {variant.name: [(1e-3, 1e-2), (1e-2, 1e-1)] for variant in study.variants}
    series = []
    pages = [embedded(convergence(study, curves, {}, "error [-]", "a title"), number, "words", series) for number in (1, 2)]
    assert series == [*curves, "order 1", "order 2"]
    for number, svg in enumerate(pages, 1):
        for k in range(len(series)):
            assert svg.count(f'<g id="figure{number}-series{k}">') == 1 and svg.count(f'<g id="figure{number}-entry{k}">') == 2
        assert not re.search(r"https?:|xlink|<!--|<metadata", svg)
        names = set(re.findall(r' id="([^"]+)"', svg))
        assert set(re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', svg)) and all(name.startswith(f"figure{number}-") for name in names)
        assert {a or b for a, b in re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', svg)} <= names


def test_comparison_tells_all_methods_apart():
    """A line of its own for every method of the shipped study, and a legend with a title that hides no panel and no label."""
    study = read_study(DECKS / "talk" / "reasonable.toml")
    points = [{"cpu_seconds": 10.0 ** -k, "e8": 10.0 ** (k - 6), "messages": 10**k, "collectives": k, "bytes": 100**k} for k in range(6)]
    for subdomains in (1, 8):
        figure = comparison(study, {variant.name: points for variant in study.variants}, subdomains, "a title")
        figure.savefig(io.BytesIO())
        assert len(figure.axes) == (1 if subdomains == 1 else 3) and all("[" in ax.get_xlabel() for ax in figure.axes)
        for ax in figure.axes:
            assert len({(line.get_color(), line.get_linestyle()) for line in ax.lines}) == len(study.variants)
        legend = figure.legends[0]
        assert legend.get_title().get_text() == "method"
        box = legend.get_window_extent()
        assert box.x0 >= 0 and box.y0 >= 0 and box.x1 <= figure.bbox.x1
        assert not any(box.overlaps(ax.get_tightbbox()) for ax in figure.axes)


@with_program
def test_what_a_solution_costs(tmp_path, render_only):
    """The smallest scene of the study of the page, with fewer bricks, on one and four subdomains: messages of several only, more
    with every iteration, and interior points that need none on one."""
    render_only("case-1-effort-4")
    text = (DECKS / "talk" / "reasonable.toml").read_text()
    text = re.sub(r"subdomains = .*", "subdomains = [1, 4]", text).replace("values = [8, 64]", "values = [4]").replace("= [8]", "= [4]")
    text = text.replace('"solver.maximum_sweeps" = 60', '"solver.maximum_sweeps" = 6')
    head, *blocks = text.replace('"../', f'"{DECKS}/').split("[[")
    kept = [block for block in blocks if block.startswith("variant") or "brick_wall" in block]
    assert len(kept) < len(blocks)
    assert kept[0].count("steps = 1\n") == 1
    kept[0] = kept[0].replace("steps = 1\n", 'steps = 1\nset = { "brick_wall[1].rows" = 6, "brick_wall[1].columns" = 4 }\n')
    kept[0] = kept[0].replace('"solver.maximum_sweeps" = 20000', '"solver.maximum_sweeps" = 400')
    code, out = done(tmp_path, written(tmp_path, "[[".join([head, *kept])))
    assert code == 0 and (out / "case-1-effort-4.png").exists()
    with open(out / "efforts.csv", newline="") as file:
        efforts = {(row["variant"], row["subdomain"], row["level"]): row for row in csv.DictReader(file)}
    assert all(int(efforts["dual", subdomains, "0.01"]["iteration"]) > 0 for subdomains in ("1", "4"))
    with open(out / "histories.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    runs = {}
    for row in rows:
        runs.setdefault((row["variant"], row["subdomain"]), []).append([int(row[name]) for name in ("messages", "bytes", "collectives")])
    assert len(runs) == 13
    for (_, subdomains), counts in runs.items():
        for column in zip(*counts, strict=True):
            assert list(column) == sorted(column) and (column[-1] > 0) == (subdomains == "4")


@with_program
def test_what_fails_is_told_and_tried_again(tmp_path, capsys):
    path = written(tmp_path, GOOD.replace("solver.order", "solver.ordre"))
    for _ in range(2):
        code, out = done(tmp_path, path)
        printed = capsys.readouterr()
        assert code == 1 and 'unknown key "ordre"' in printed.err and printed.err.count("\n") == 1
        assert "1 of 1 runs to do" in printed.out and not list((out / "runs").iterdir())


@with_program
def test_program_hands_over(tmp_path):
    path = written(tmp_path, GOOD.replace("repeats", "repeat"), "with a blank.toml")
    message = subprocess.run([PROGRAM, "study", str(path)], capture_output=True, text=True, timeout=120, cwd=tmp_path)
    assert message.returncode == 2 and message.stderr.startswith(f"{path}:2: error: unknown key 'repeat'")


@with_program
def test_folder_that_cannot_be_written(tmp_path, capsys):
    (tmp_path / "out").write_text("a file")
    code, _ = done(tmp_path, written(tmp_path, GOOD))
    printed = capsys.readouterr().err
    assert code == 5 and "cannot write" in printed and printed.count("\n") == 1


@with_program
@pytest.mark.parametrize(("steps", "has_profile"), [([4, 5], False), ([3, 4, 5], True)])
def test_profiles_need_three_cases(tmp_path, render_only, steps, has_profile):
    render_only("profile-*")
    if not re.search(r"^HDF5\s+on", subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout, re.M):
        pytest.skip("the program is built without HDF5")
    text = STONES.replace("[1e-2, 1e-6]", "[1e-2]").replace("dump = 5", f"dump = {steps}").replace("[reference]\ntolerance = 1e-11\n", "")
    code, out = done(tmp_path, written(tmp_path, text))
    page = (out / "study.html").read_text()
    assert code == 0 and len({row["case"] for row in rows_of(out)}) == len(steps)
    assert ("Performance profile" in page, "Shares of problems solved" in page) == (has_profile, not has_profile)
    assert bool(list(out.glob("profile-*"))) == has_profile
