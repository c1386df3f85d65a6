#!/usr/bin/env python3
"""Folders of results from outside: what is replaced, what is left alone, locks, links, signals, checkpoints at the end.

usage: test_folders.py PROGRAM [unittest options]
"""

import json
import os
import resource
import shutil
import signal
import socket
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from program_case import ProgramCase, take_program
from test_cli import DECK

try:
    import h5py
except ImportError:
    h5py = None

LONG = ["--set", "time.steps=100000000", "--set", "output.record_every=100"]


class Folders(ProgramCase):
    def setUp(self):
        super().setUp()
        (self.place / "fall.toml").write_text(DECK)

    def run_deck(self, *words, code=0, deck="fall.toml", output="out"):
        return self.run_program("run", deck, "--output", output, *words, code=code)

    def contents(self, folder="out"):
        """All files of a folder, with their bytes and times."""
        return {path.name: (path.read_bytes(), path.stat().st_mtime_ns) for path in (self.place / folder).iterdir()}

    def run_json(self, folder="out"):
        return json.loads((self.place / folder / "run.json").read_text())

    def refused(self, said, *words, code=2, **options):
        """A run is refused with one sentence, and leaves the folder as it was."""
        before = self.contents() if (self.place / "out").exists() else None
        done = self.run_deck(*words, code=code, **options)
        self.assertRegex(done.stderr, said)
        self.assertEqual(before, self.contents() if (self.place / "out").exists() else None)

    def start(self, *words, **options):
        """Start a run that would last for hours, and wait for its first rows."""
        program = subprocess.Popen([self.program, "run", "fall.toml", "--output", "out", *LONG, *words], cwd=self.place,
                                   stderr=subprocess.PIPE, text=True, **{"stdout": subprocess.DEVNULL, **options})
        self.addCleanup(program.stderr.close)
        self.addCleanup(program.kill)
        record, end = self.place / "out" / "record.csv", time.monotonic() + 60
        while not record.exists() or record.read_text().count("\n") < 2:
            self.assertLess(time.monotonic(), end, "nothing happens")
            time.sleep(0.02)
        return program


class Ended(Folders):
    def setUp(self):
        super().setUp()
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")

    def test_a_finished_run_leaves_a_checkpoint_and_nothing_to_do(self):
        self.run_deck("--quiet")
        before = self.contents()
        self.assertIn("restart_a.h5", before)
        self.assertEqual(self.run_json()["file_restart"], "restart_a.h5")
        for steps in (120, 50):
            done = self.run_deck("--restart", "out", "--set", f"time.steps={steps}")
            self.assertIn(f"nothing to do: step 120 of {steps}", done.stdout)
            self.assertEqual(self.contents(), before)
        self.run_deck("--restart", "out", output="other")
        self.assertFalse((self.place / "other").exists())
        self.run_deck("--restart", "out", "--set", "time.steps=130", "--quiet")
        self.assertEqual((self.run_json()["status"], self.run_json()["steps"]), ("done", 130))

    def test_no_checkpoint_where_none_is_wanted(self):
        self.run_deck("--quiet", "--set", "restart.at_end=false")
        self.assertNotIn("restart_a.h5", self.contents())

    def test_a_step_that_does_not_converge_leaves_a_checkpoint(self):
        self.run_deck("--quiet", "--set", "solver.maximum_sweeps=1", "--set", "solver.check_every=1", "--set",
                      "solver.stop_unconverged=true", "--set", "solver.tolerance=1e-14", code=3)
        self.assertIn("restart_a.h5", self.contents())

    def test_the_newest_checkpoint_is_damaged(self):
        every = ["--quiet", "--set", "restart.every=50"]
        self.run_deck(*every)
        self.run_deck("--quiet", "--set", "time.steps=140", output="straight")
        newest = self.place / "out" / "restart_a.h5"
        data = bytearray(newest.read_bytes())
        data[len(data) // 2:len(data) // 2 + 200] = bytes(200)
        newest.write_bytes(data)
        self.refused("restart_a.h5", "--restart", "out/restart_a.h5", "--set", "time.steps=140")
        done = self.run_deck("--restart", "out", "--set", "time.steps=140", "--quiet")
        self.assertRegex(done.stderr, "restart_a.h5: warning: .* the run goes on from the older out/restart_b.h5 of step 100")
        for key in ("steps", "kinetic_energy", "potential_energy"):
            self.assertEqual(self.run_json()[key], self.run_json("straight")[key], key)

    def test_a_checkpoint_that_has_more_numbers_than_bytes(self):
        """HDF5 reads numbers that were never written as zeros, gigabytes of them."""
        if h5py is None:
            self.skipTest("no h5py")
        self.run_deck("--quiet")
        # Of a scene that does not fit, only check sums are tried.
        stored = "/time has 1073741824 entries, but no more than 0 bytes in the file"
        for name, said, other in (("time", "/time has 1073741824 rows", []), ("totals", "it is cut off", []),
                                  ("time", stored, ["--set", "sample[1].count=11"])):
            shutil.copy(self.place / "out" / "restart_a.h5", self.place / "spoilt.h5")
            with h5py.File(self.place / "spoilt.h5", "r+") as file:
                del file[name]
                file.create_dataset(name, (2**30,), "f8", chunks=(4096,))
            self.refused(f"spoilt.h5: error: {said}", "--restart", "spoilt.h5", "--set", "time.steps=140", *other)
        # They would take 8 GiB.
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, 2**20, "KiB of the largest process so far")

    def test_a_problem_that_has_more_numbers_than_bytes(self):
        if h5py is None:
            self.skipTest("no h5py")
        self.run_deck("--quiet", "--dump", "120")
        with h5py.File(self.place / "out" / "dump-120-local.hdf5", "r+") as file:
            del file["fclib_local/vectors/q"]
            file.create_dataset("fclib_local/vectors/q", (2**30,), "f8", chunks=(4096,))
        done = self.run_program("solve", "out/dump-120-local.hdf5", code=2)
        self.assertIn("/fclib_local/vectors/q has 1073741824 entries, but no more than 0 bytes in the file", done.stderr)
        # Zeros of one byte each, pressed together as far as gzip can, are all there and are read.
        with h5py.File(self.place / "out" / "dump-120-local.hdf5", "r+") as file:
            del file["fclib_local/vectors/q"]
            file.create_dataset("fclib_local/vectors/q", (2**22,), "u1", chunks=(2**22,), compression=9)[...] = 0
        done = self.run_program("solve", "out/dump-120-local.hdf5", code=2)
        self.assertNotIn("bytes in the file", done.stderr)
        self.assertIn("/fclib_local/vectors/mu has 12 entries, not 2097152", done.stderr)


class Others(Folders):
    def test_other_results_are_not_replaced_unasked(self):
        self.run_deck("--quiet")
        self.refused("out: error: this folder holds results of another deck.*--force", "--set", "time.steps=60")
        self.run_deck("--quiet", "--set", "time.steps=60", "--force")
        self.assertEqual(self.run_json()["steps"], 60)
        # The same deck gives the same results.
        self.run_deck("--quiet", "--set", "time.steps=60")
        self.refused("option --output needs a value", output="")

    def test_a_run_that_has_not_ended_is_not_begun_again_unasked(self):
        if not self.has_hdf5():
            self.skipTest("a build without HDF5 has no checkpoints")
        self.run_until_walltime(self.run_deck, *LONG, "--quiet")
        self.refused("a run that has not ended: --restart out", *LONG, "--walltime", "60")

    def test_files_that_are_read_are_not_written_over(self):
        self.run_deck("--quiet")
        for deck, output in (("out/effective.toml", "out"), ("effective.toml", ".")):
            (self.place / deck).write_text((self.place / "out/effective.toml").read_text())
            before = (self.place / deck).read_bytes()
            said = self.run_deck("--force", deck=deck, output=output, code=2).stderr
            self.assertRegex(said, "effective.toml: error: the run reads this file and would write over it")
            self.assertEqual((self.place / deck).read_bytes(), before)
        drive = '[[drive]]\nbody = 1\ncomponent = "x"\nfile = "driven/record.csv"\n'
        (self.place / "driven").mkdir()
        (self.place / "driven/record.csv").write_text("0 0\n1 0\n")
        (self.place / "driven.toml").write_text(DECK + drive)
        said = self.run_deck("--force", deck="driven.toml", output="driven", code=2).stderr
        self.assertRegex(said, "record.csv: error: the run reads this file")
        self.assertEqual((self.place / "driven/record.csv").read_text(), "0 0\n1 0\n")

    def test_links_are_not_followed_out_of_the_folder(self):
        aside = self.place / "aside"
        aside.write_text("kept")
        (self.place / "out").mkdir()
        names = ["record.csv", "run.json", "effective.toml", "numbers.tag", "restart_a.h5", "bodies.vtkhdf", "bodies.xmf"]
        for name in [*names, *[f"{name}.part" for name in names], "run.lock.part"]:
            (self.place / "out" / name).symlink_to(aside)
        pictures = ["--set", "output.every=60"] if self.has_hdf5() else []
        self.run_deck("--quiet", "--force", *pictures)
        self.assertEqual(aside.read_text(), "kept")
        self.assertEqual([name for name in names if (self.place / "out" / name).is_symlink() and name != "bodies.vtkhdf"], [])
        if not pictures:
            return
        bodies = self.place / "out" / "bodies.vtkhdf"
        bodies.rename(self.place / "moved")
        bodies.symlink_to(self.place / "moved")
        self.run_deck("--quiet", *pictures, "--set", "time.steps=130", "--restart", "out", code=5)


class Locks(Folders):
    def lock(self, text):
        (self.place / "out").mkdir(exist_ok=True)
        (self.place / "out" / "run.lock").write_text(text)

    def test_two_runs_do_not_share_a_folder(self):
        program = self.start("--quiet")
        lock = (self.place / "out" / "run.lock").read_text()
        self.assertIn(f"process {program.pid}\n", lock)
        for words in ([], ["--force"]):
            said = self.run_deck(*words, code=2).stderr
            self.assertIn(f"another run writes to this folder, process {program.pid} of this host", said)
        program.kill()
        program.wait(60)
        self.assertEqual((self.place / "out" / "run.lock").read_text(), lock)
        self.run_deck("--force", "--quiet")
        self.assertFalse((self.place / "out" / "run.lock").exists())

    def test_a_run_killed_at_its_start_leaves_no_lock_without_a_process(self):
        lock = self.place / "out" / "run.lock"
        for _ in range(20):
            lock.unlink(missing_ok=True)
            program = subprocess.Popen([self.program, "run", "fall.toml", "--output", "out", "--quiet", *LONG], cwd=self.place,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            end = time.monotonic() + 60
            while not lock.exists() and program.poll() is None:
                self.assertLess(time.monotonic(), end, "nothing happens")
            program.kill()
            program.wait(60)
            self.assertIn(f"process {program.pid}\n", lock.read_text())
        ended = subprocess.Popen(["true"])
        ended.wait()
        here = socket.gethostname()
        left = self.place / "out" / f"run.lock.{here}.{ended.pid}"
        living = self.place / "out" / f"run.lock.{here}.{os.getpid()}"
        left.write_text("")
        living.write_text("")
        self.run_deck("--force", "--quiet")
        self.assertEqual([path.name for path in (self.place / "out").glob("run.lock*")], [living.name])

    def test_stale_locks(self):
        here = socket.gethostname()
        ended = subprocess.Popen(["true"])
        ended.wait()
        for text in (f"host {here}\nprocess {ended.pid}\nstarted 1\n", f"host {here}\nprocess {os.getpid()}\nstarted 1\n"):
            self.lock(text)
            self.run_deck("--quiet")
            self.assertFalse((self.place / "out" / "run.lock").exists())
        for text, said in (("host elsewhere\nprocess 7\nstarted 1\n", "process 7 of host elsewhere"), ("", "names no process")):
            self.lock(text)
            self.refused(said)
            self.run_deck("--quiet", "--force")


class Signals(Folders):
    def test_the_end_of_a_terminal_or_of_a_reader_ends_the_run(self):
        for number in (signal.SIGHUP, signal.SIGPIPE):
            with self.subTest(signal=number.name):
                shutil.rmtree(self.place / "out", ignore_errors=True)
                program = self.start("--quiet")
                program.send_signal(number)
                self.assertEqual(program.wait(60), 75)
                self.assertEqual(self.run_json()["reason"][:20], f"stopped by signal {int(number)} "[:20])
                self.assertEqual((self.place / "out" / "restart_a.h5").exists(), self.has_hdf5())

    def test_a_signal_that_is_ignored_stays_ignored(self):
        program = self.start("--quiet", preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        program.send_signal(signal.SIGHUP)
        time.sleep(0.3)
        self.assertIsNone(program.poll())
        program.kill()
        program.wait(60)


class Faults(Folders):
    def limited(self, limit, *words):
        """Run the program with files limited to so many bytes, as on a full disk."""
        def limit_files():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        return subprocess.run([self.program, *words], cwd=self.place, capture_output=True, text=True, timeout=60, preexec_fn=limit_files)

    def test_standard_output_that_takes_nothing(self):
        words = (["--help"], ["--version"], ["reference"], ["check", "fall.toml"], ["partition", "fall.toml", "--parts", "2"],
                 ["run", "fall.toml"])
        for command in words:
            with self.subTest(command=command), open("/dev/full", "w") as full:
                done = subprocess.run([self.program, *command], cwd=self.place, stdout=full, stderr=subprocess.PIPE, text=True)
                self.assertEqual(done.returncode, 5)
                self.assertIn("error: standard output cannot be written", done.stderr)
        self.assertEqual(self.run_json("fall.results")["status"], "done")

    def test_a_reader_that_goes_away_ends_the_run(self):
        program = self.start(stdout=subprocess.PIPE)
        program.stdout.close()
        # The next line of progress comes within five seconds.
        self.assertEqual(program.wait(60), 75)
        self.assertEqual(self.run_json()["reason"][:20], "stopped by signal 13")

    def test_conversions_are_whole_or_not_there(self):
        self.run_program("convert", "fall.toml", "whole")
        sizes = {path.name: path.stat().st_size for path in (self.place / "whole").iterdir()}
        for limit in (0, 100, max(sizes.values()) - 1):
            target = f"made{limit}"
            done = self.limited(limit, "convert", "fall.toml", target)
            self.assertEqual(done.returncode, 5)
            self.assertRegex(done.stderr, "error: cannot write the file")
            for path in (self.place / target).iterdir():
                self.assertEqual(path.stat().st_size, sizes[path.name])
        self.assertEqual(self.limited(100, "convert", "whole", "again.toml").returncode, 5)
        self.assertFalse((self.place / "again.toml").exists())

    def test_results_are_whole_or_not_there(self):
        pictures = ["--set", "output.every=10", "--dump", "120"] if self.has_hdf5() else []
        # Texts alone are small.
        for limit in (0, 1000, 4000, 20000) if pictures else (0, 1000):
            shutil.rmtree(self.place / "fall.results", ignore_errors=True)
            done = self.limited(limit, "run", "fall.toml", "--quiet", *pictures)
            self.assertEqual(done.returncode, 5, done.stderr)
            for path in (self.place / "fall.results").iterdir():
                self.assertGreater(path.stat().st_size, 0, path)
                self.assertNotEqual(path.suffix, ".part", path)

    def test_an_answer_that_cannot_be_written_leaves_the_problem(self):
        if not self.has_hdf5():
            self.skipTest("built without HDF5")
        self.run_deck("--quiet", "--dump", "120")
        problem = self.place / "out" / "dump-120-local.hdf5"
        before = problem.read_bytes()
        for limit in (1000, len(before) - 1):
            done = self.limited(limit, "solve", "out/dump-120-local.hdf5", "--write", "--force")
            self.assertEqual(done.returncode, 5, done.stderr)
            self.assertEqual(problem.read_bytes(), before)
        said = self.run_program("solve", "out/dump-120-local.hdf5", "--trace", "out/dump-120-local.hdf5", code=2).stderr
        self.assertIn("dump-120-local.hdf5: error: this file is read", said)
        self.assertEqual(problem.read_bytes(), before)
        (self.place / "link.hdf5").symlink_to(problem)
        self.run_program("solve", "link.hdf5", "--write", "--force")
        self.assertTrue((self.place / "link.hdf5").is_symlink())
        self.assertNotEqual(problem.read_bytes(), before)
        self.assertEqual([path.name for path in (self.place / "out").glob("*.part")], [])

    def test_an_answer_leaves_all_else_of_the_file(self):
        if not self.has_hdf5() or h5py is None:
            self.skipTest("built without HDF5, or no h5py")
        self.run_deck("--quiet", "--dump", "120")
        problem = self.place / "out" / "dump-120-local.hdf5"
        with h5py.File(problem, "r+") as file:
            self.assertRegex(file["fclib_local/info/title"][()].decode(), r"^step 120 of .*\.toml$")
            file.attrs["author"] = "someone"
            file.attrs.create("numbers", [1.5, 2.5])
            file["notes/length"] = "of any length"
            file["solution/r"][...] = 7.0
        problem.chmod(0o640)
        self.run_program("solve", "out/dump-120-local.hdf5", "--write", "--force")
        self.assertEqual(problem.stat().st_mode & 0o777, 0o640)
        with h5py.File(problem) as file:
            self.assertEqual(file.attrs["author"], "someone")
            self.assertEqual(list(file.attrs["numbers"]), [1.5, 2.5])
            self.assertEqual(file["notes/length"][()], b"of any length")
            self.assertFalse((file["solution/r"][()] == 7.0).any())

    def test_a_damaged_old_answer_is_left_out(self):
        """HDF5 crashes where it removes a dataset with this bit of its header flipped; a copy does without it."""
        if not self.has_hdf5() or h5py is None:
            self.skipTest("built without HDF5, or no h5py")
        self.run_deck("--quiet", "--dump", "120")
        problem = self.place / "out" / "dump-120-local.hdf5"
        with h5py.File(problem) as file:
            flags = h5py.h5o.get_info(file["solution/r"].id).addr + 20
        data = bytearray(problem.read_bytes())
        data[flags] ^= 64
        problem.write_bytes(data)
        self.run_program("solve", "out/dump-120-local.hdf5", "--write", "--force")
        with h5py.File(problem) as file:
            self.assertEqual(file["solution/r"].shape, file["fclib_local/vectors/q"].shape)

    def test_a_dataset_larger_than_its_file_is_not_copied(self):
        """HDF5 crashes where it copies a dataset whose header claims more bytes than there are."""
        if not self.has_hdf5() or h5py is None:
            self.skipTest("built without HDF5, or no h5py")
        self.run_deck("--quiet", "--dump", "120")
        problem = self.place / "out" / "dump-120-local.hdf5"
        with h5py.File(problem) as file:
            item = file["fclib_local/W/p"].id
            place, size = item.get_offset(), item.get_storage_size()
        layout = place.to_bytes(8, "little") + size.to_bytes(8, "little")
        data = problem.read_bytes()
        self.assertEqual(data.count(layout), 1)
        before = data.replace(layout, place.to_bytes(8, "little") + (size + 2**40).to_bytes(8, "little"))
        problem.write_bytes(before)
        done = self.run_program("solve", "out/dump-120-local.hdf5", "--write", "--force", code=2)
        self.assertIn("cannot copy what it holds, is the file damaged?", done.stderr)
        self.assertEqual(problem.read_bytes(), before)


if __name__ == "__main__":
    take_program()
    unittest.main()
