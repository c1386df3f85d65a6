"""The program, which comes with this package, or is that of a build or an installation."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Thread

HERE = Path(__file__).resolve().parent


def program_path() -> str:
    """Where the program is: SPLITGRAIN_PROGRAM, that of the wheel, of the build beside this source, or on the path."""
    given = os.environ.get("SPLITGRAIN_PROGRAM")
    places = [given] if given else [HERE / "data/bin/splitgrain", HERE.parents[1] / "build/release/splitgrain", _on_the_path()]
    for place in places:
        if place and os.access(place, os.X_OK):
            return str(place)
    raise FileNotFoundError(f"there is no program {given}" if given else
                            "there is no splitgrain: build it (./start build), install it, or set SPLITGRAIN_PROGRAM")  # fmt: skip


def _on_the_path():
    """A splitgrain on the path that is not the script of this package."""
    found = shutil.which("splitgrain")
    return found if found and Path(found).resolve() != Path(sys.argv[0]).resolve() else None


def version() -> dict[str, str]:
    """Version, commit, compiler, flags and libraries of the program."""
    printed = subprocess.run([program_path(), "--version"], capture_output=True, text=True, check=True).stdout.splitlines()
    lines = [line.split(maxsplit=1) for line in printed]
    return {"version" if words[0] == "splitgrain" else words[0]: words[1] if len(words) > 1 else "" for words in lines if words}


def call(words: Sequence[str], ranks: int = 1, progress: Callable[[str], object] | bool = False) -> tuple[int, str]:
    """Call the program on some ranks; returns its exit code and its errors. progress: takes each line printed, or prints it."""
    launcher = ["mpiexec", "-n", str(ranks)] if ranks > 1 else []
    show = (lambda line: print(line, flush=True)) if progress is True else progress or (lambda line: None)
    # Open MPI makes its own folder below TMPDIR, whose path must be short.
    environment = {name: value for name, value in os.environ.items() if name != "TMPDIR"}
    with subprocess.Popen([*launcher, program_path(), *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          stdin=subprocess.DEVNULL, env=environment) as process:
        errors: list[str] = []
        reader = Thread(target=lambda: errors.append(process.stderr.read()))
        reader.start()
        try:
            for line in process.stdout:
                show(line.rstrip("\n"))
        except BaseException:
            process.terminate()
            raise
        finally:
            reader.join()
    return process.returncode, errors[0]


def main() -> None:
    """The command `splitgrain` of the wheel: become the program."""
    program = program_path()
    # Drawing goes on in the Python of this package.
    os.environ["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', os.defpath)}"
    os.execv(program, [program, *sys.argv[1:]])
