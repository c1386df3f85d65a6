"""`start` on a machine without packages for Python: help installs nothing, an apt-get that is locked is waited for, and so is another
build in the same folder. Source checks come before builds."""

import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[1]
# Says that it is locked as long as there is a mark less than in LOCKED, then that it did its work.
APT = """#!/bin/sh
echo "$@" >>"$MARKS/apt"
[ "$(wc -l <"$MARKS/apt")" -gt "$LOCKED" ] || { echo 'E: Could not get lock /var/lib/apt/lists/lock. It is held by process 1'; exit 100; }
[ "$ENDS" -eq 0 ] || echo 'E: Unable to fetch some archives'
exit "$ENDS"
"""
# Leaves a mark when it begins, and one when it ends a moment later.
CMAKE = """#!/bin/sh
echo begins >>"$MARKS/cmake"
/bin/sleep 0.3
echo ends >>"$MARKS/cmake"
"""


@pytest.fixture
def start(tmp_path):
    """Runs `start` with a Python that has the standard library alone, an apt-get and a cmake that only leave marks, and a sleep that takes no
    time."""
    (tmp_path / "bin").mkdir()
    programs = {"python3": f'#!/bin/sh\nexec "{sys.executable}" -S "$@"\n', "apt-get": APT, "cmake": CMAKE,
                "dpkg-query": "#!/bin/sh\nexit 1\n",
                "sleep": '#!/bin/sh\necho "$1" >>"$MARKS/sleep"\n'}
    for name, text in programs.items():
        (tmp_path / "bin" / name).write_text(text)
        (tmp_path / "bin" / name).chmod(0o755)
    (tmp_path / "start").write_text((TOP / "start").read_text().replace("/usr/bin/python3", str(tmp_path / "bin/python3")))
    (tmp_path / "postpro").symlink_to(TOP / "postpro")

    def run(*words, locked=0, ends=0):
        environment = {**os.environ, "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}", "MARKS": str(tmp_path), "LOCKED": str(locked), "ENDS": str(ends)}
        environment.pop("PYTHONPATH", None)
        done = subprocess.run(["sh", tmp_path / "start", *words], capture_output=True, text=True, env=environment, timeout=60)
        marks = {name: (tmp_path / name).read_text().splitlines() if (tmp_path / name).exists() else [] for name in ("apt", "cmake", "sleep")}
        return done, marks

    return run


needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="without root packages are installed by sudo")


@pytest.mark.parametrize("words", [["look", "--help"], ["look", "scene", "-h"], ["look"], ["help"], ["--help"]])
def test_help_installs_nothing(start, words):
    done, marks = start(*words)
    assert not marks["apt"]
    assert "usage:" in done.stdout + done.stderr or "./start look" in done.stdout
    assert done.returncode == (2 if words == ["look"] else 0)


@needs_root
def test_a_locked_apt_is_waited_for(start):
    done, marks = start("look", "scene", "nowhere", locked=3)
    # Three calls find the lock, one refreshes the lists, one installs; the fake installs nothing, which is then reported.
    assert len(marks["apt"]) == 5 and marks["sleep"] == ["5"] * 3
    assert "update" in marks["apt"][0] and "install" in marks["apt"][4]
    assert done.stderr.count("another apt-get is at work") == 1 and done.returncode != 0


@needs_root
def test_another_failure_of_apt_is_not_waited_for(start):
    done, marks = start("look", "scene", "nowhere", ends=1)
    assert len(marks["apt"]) == 2 and not marks["sleep"]
    assert "Unable to fetch some archives" in done.stderr and "apt-get could not install" in done.stderr and done.returncode != 0


@needs_root
def test_waiting_ends_after_five_minutes(start):
    done, marks = start("look", "scene", "nowhere", locked=1000)
    assert "Could not get lock" in done.stderr and done.returncode != 0
    assert len(marks["sleep"]) == 2 * 300 // 5


@needs_root
@pytest.mark.skipif(shutil.which("flock") is None, reason="without flock builds do not wait for each other")
def test_two_builds_in_one_folder_wait_for_each_other(start):
    with ThreadPoolExecutor() as pool:
        runs = list(pool.map(lambda _: start("build"), range(2)))
    assert all(done.returncode == 0 for done, _ in runs)
    # Each configures, since the fake writes no files, and builds.
    assert max((marks["cmake"] for _, marks in runs), key=len) == ["begins", "ends"] * 4


@needs_root
def test_sources_are_not_looked_through_again(start, tmp_path):
    folder = tmp_path / "build/release/CMakeFiles/core.dir"
    folder.mkdir(parents=True)
    (tmp_path / "build/release/build.ninja").touch()
    (folder / "alone.f90.o.ddi.d").write_text("/top/src/alone.f90:\n")
    (folder / "including.f90.o.ddi.d").write_text("/top/src/including.f90: \\\n /top/src/other.inc\n")
    (folder / "right.f90.o.ddi.d").write_text("CMakeFiles/core.dir/right.f90.o.ddi: \n")
    done, _ = start("build")
    assert done.returncode == 0
    assert (folder / "alone.f90.o.ddi.d").read_text() == "CMakeFiles/core.dir/alone.f90.o.ddi:\n"
    # What a source includes must stay known, and what ninja finds already stays.
    assert (folder / "including.f90.o.ddi.d").read_text() == "/top/src/including.f90: \\\n /top/src/other.inc\n"
    assert (folder / "right.f90.o.ddi.d").read_text() == "CMakeFiles/core.dir/right.f90.o.ddi: \n"


def test_a_finding_ends_before_anything_is_built(tmp_path):
    shutil.copy(TOP / "start", tmp_path)
    (tmp_path / ".ci").mkdir()
    for name in ("check_layers", "draw_rooms"):
        (tmp_path / ".ci" / name).write_text(f"import sys\nprint(*sys.argv)\nsys.exit({int(name == 'draw_rooms')})\n")
    done = subprocess.run(["sh", tmp_path / "start", "test"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert done.stdout.splitlines() == [f"{tmp_path}/.ci/check_layers {tmp_path}", f"{tmp_path}/.ci/draw_rooms --check {tmp_path}"]
    assert not (tmp_path / "build").exists()
