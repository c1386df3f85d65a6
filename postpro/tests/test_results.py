"""The record and the text about a run."""

import numpy as np
import pytest
from sample_results import write_record, write_results

from splitgrain_postpro import Results, ResultsError
from splitgrain_postpro.results import read_record, read_tracks
from splitgrain_postpro.text import headline, summary_text


def test_record_has_every_column_and_row(tmp_path):
    write_record(tmp_path, 20)
    record = read_record(tmp_path / "record.csv")
    assert record["step"].tolist() == list(range(1, 21))
    assert record["cpu_seconds"][-1] == pytest.approx(0.4)
    assert len(record) == 42


def test_row_cut_short_is_left_out(tmp_path):
    write_record(tmp_path, 20)
    path = tmp_path / "record.csv"
    path.write_text(path.read_text()[:-40])
    assert len(read_record(path)["time"]) == 19


def test_numbers_that_are_none(tmp_path):
    path = tmp_path / "record.csv"
    path.write_text("step,converged,e1\n1,T,nan\n2,false,inf\n3,1,\n")
    record = read_record(path)
    assert record["converged"].tolist() == [1, 0, 1]
    assert np.isnan(record["e1"][[0, 2]]).all() and np.isinf(record["e1"][1])


@pytest.mark.parametrize("text, message", [
    ("", "no line of names"),
    ("step,time\n1\n2,0.5\n", "row 1 has 1 values for 2 names"),
])  # fmt: skip
def test_spoilt_record(tmp_path, text, message):
    path = tmp_path / "record.csv"
    path.write_text(text)
    with pytest.raises(ResultsError, match=message):
        read_record(path)


def test_tracks(tmp_path):
    path = tmp_path / "tracks.csv"
    path.write_text('step,time,body,x\n5,0.1,"a, ""b""",1.5\n5,0.1,7,nan\n10,0.2,"a, ""b""",2.5\n10,0.2,7,-1\n15,0.3,7\n')
    tracks = read_tracks(path)
    assert list(tracks) == ['a, "b"', "7"] and list(tracks["7"]) == ["step", "time", "x"]
    assert tracks['a, "b"']["x"].tolist() == [1.5, 2.5] and tracks["7"]["x"][1] == -1
    (tmp_path / "regions.csv").write_text("step,time,region,grains\n5,0.1,low,3\n")
    assert read_tracks(tmp_path / "regions.csv", "region")["low"]["grains"].tolist() == [3]
    path.write_text("step,time,body,x\n")
    assert read_tracks(path) == {}
    for text, message in (("", "no line of names"), ("step,time,body,x\n1,0,a\n2,0,a,1\n", "cannot read"),
                          ("step,time,body,x\n1,0,a,word\n2,0,a,1\n", "could not convert")):
        path.write_text(text)
        with pytest.raises(ResultsError, match=message):
            read_tracks(path)


def test_text_of_a_finished_run(tmp_path):
    results = Results(write_results(tmp_path / "run", columns=5, rows=3))
    text = summary_text(results)
    rows = dict(line.split("  ", 1) for line in text.splitlines())
    values = {words.strip(): value.strip() for words, value in rows.items()}
    assert values["run"] == "run, done"
    assert values["steps"] == "20" and values["not converged"] == "2"
    assert values["bodies"] == "16" and values["sweeps"] == "1,234"
    assert values["worst E8"] == "0.00042" and values["CPU time"] == "12.5 s"
    # JSON has null where a number is not finite: such a line is left out.
    assert "worst E1" not in values
    assert "16 bodies" in headline(results)


def test_text_while_the_run_goes_on(tmp_path):
    text = summary_text(Results(write_results(tmp_path / "run", columns=5, rows=3, finished=False)), ["no pictures"])
    assert "not finished" in text and "not there" in text
    assert "sweeps" not in text


def test_text_of_a_failed_run(tmp_path):
    (tmp_path / "run.json").write_text('{"status": "failed", "reason": "the disk is full"}')
    assert "failed: the disk is full" in summary_text(Results(tmp_path))


@pytest.mark.parametrize("content", ["{", "[1]", ""])
def test_spoilt_run_json(tmp_path, content):
    (tmp_path / "run.json").write_text(content)
    with pytest.raises(ResultsError, match="cannot read .*run.json"):
        summary_text(Results(tmp_path))
