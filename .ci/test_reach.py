"""Test how `.ci/reach` reads what was counted, and orders tests."""

import os
import subprocess
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

loader = SourceFileLoader("reach", str(Path(__file__).with_name("reach")))
reach = module_from_spec(spec_from_loader("reach", loader))
loader.exec_module(reach)


def test_lines_of_a_program(tmp_path):
    """Lines of a run that takes one way, and of one that takes the other."""
    source = tmp_path / "way.c"
    source.write_text("int main(int n, char **words)\n{\n  (void)words;\n  if (n > 1)\n    return 0;\n  return 1;\n}\n")
    subprocess.run(["gcc", "-O0", "--coverage", "way.c", "-o", "way"], cwd=tmp_path, check=True)
    found = {}
    for name, words in (("short", []), ("long", ["x"])):
        subprocess.run([tmp_path / "way", *words], env=dict(os.environ, GCOV_PREFIX=str(tmp_path / name)), check=False)
        found[name] = {line for _, line in reach.lines_run(tmp_path / "build", tmp_path / name)}
    assert (found["short"] - found["long"], found["long"] - found["short"]) == ({6}, {5})
    assert reach.lines_run(tmp_path, tmp_path / "nowhere") == set()


def test_order():
    """What adds most per second comes first, and what adds nothing last."""
    lines = {"dear": {1, 2, 3}, "cheap": {1, 2}, "other": {4}, "same": {1}}
    rows = reach.in_order({"dear": 10.0, "cheap": 1.0, "other": 1.0, "same": 0.9}, lines)
    assert rows == [("cheap", 2), ("other", 1), ("dear", 1), ("same", 0)]
