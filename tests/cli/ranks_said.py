"""What is said on several ranks is said once: refusals, commands that one rank can do, the log."""

import re
import shutil
import subprocess

from ranks_case import COMMON, FALL, PRESSED, Ranks



class Refusals(Ranks):
    def test_bad_decks_and_wishes(self):
        self.deck(FALL.replace("friction =", "frction ="), "bad.toml")
        good = self.deck(FALL)
        for ranks, deck, said, words in (
            (3, "bad.toml", 'bad.toml:10:1: error: unknown key "frction".*; did you mean "friction"', []),
            (2, "nowhere.toml", "nowhere.toml: error: cannot read the file", []),
            (2, good, "partition.sweeps has 3 numbers; .* for each of the 2 ranks", ["--set", "partition.sweeps=[1, 2, 3]"]),
            (4, good, r"boxes 3 x 2 .* cannot make 4 parts", ["--set", "partition.boxes=[3, 2]"]),
            (2, good, 'solver "proximal" does not run on several ranks', ["--set", 'solver.method="proximal"']),
            (2, good, "unknown option --outptu", ["--outptu=x"]),
            (2, good, "--walltime needs a value", ["--walltime"]),
        ):  # fmt: skip
            with self.subTest(said=said):
                self.refused(ranks, deck, said, *words)
        self.assertEqual(self.launch((2, "rnu"), code=2).stderr.count('did you mean "run"'), 1)

    def test_ranks_that_do_not_share_one_run(self):
        good = self.deck(FALL)
        bad = self.deck(FALL.replace("friction =", "frction ="), "bad.toml")
        other = self.deck(FALL.replace("friction = 0.3", "friction = 0.4"), "other.toml")
        for words, said in (
            ([bad], "1 of 2 ranks report this, the first is rank 1"),
            (["nowhere.toml"], "1 of 2 ranks report this, the first is rank 1"),
            ([other], "the ranks do not share one run"),
            ([good, "--output", "elsewhere"], "the ranks do not share one run"),
            ([good, "--outptu", "x"], "unknown option --outptu"),
            ([good, "--walltime"], "--walltime needs a value"),
        ):
            with self.subTest(words=words):
                done = self.launch((1, "run", good, "--quiet"), (1, "run", *words), code=2)
                self.assertEqual((done.stderr.count(said), done.stderr.count("error:")), (1, 1), done.stderr)
        for folder in ("here", "there"):
            (self.place / folder).mkdir()
            self.deck(FALL, f"{folder}/deck.toml")
        done = subprocess.run(
            [self.launcher, "--oversubscribe", "-n", "1", "-wdir", self.place / "here", self.program, "run", good, ":",
             "-n", "1", "-wdir", self.place / "there", self.program, "run", good],
            env=self.environment, capture_output=True, text=True, timeout=self.timeout)  # fmt: skip
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertEqual(done.stderr.count("rank 1 does not find the folder of the results"), 1, done.stderr)


class Once(Ranks):
    def test_what_needs_no_ranks_is_done_by_one(self):
        good = self.deck(FALL)
        self.deck(FALL.replace("friction =", "frction ="), "bad.toml")
        for code, *words in (
            (0, "--help"),
            (0, "run", "--help"),
            (0, "--version"),
            (0, "reference"),
            (0, "check", good),
            (2, "check", "bad.toml"),
            (0, "convert", good, "datbox"),
            (2, "convert", "nowhere.toml", "other"),
            (0, "partition", good, "--parts", "3"),
            (2, "solve", "nowhere.hdf5"),
            (2,),
        ):
            with self.subTest(words=words):
                alone = self.run_program(*words, code=code)
                shutil.rmtree(self.place / "datbox", ignore_errors=True)
                done = self.launch((2, *words), code=code)
                self.assertEqual(done.stdout, alone.stdout)
                # The launcher has something to say of exit codes, too.
                self.assertEqual([done.stderr.count(line) for line in alone.stderr.splitlines()],
                                 [alone.stderr.count(line) for line in alone.stderr.splitlines()])  # fmt: skip

    def test_ranks_with_different_commands(self):
        good = self.deck(FALL)
        done = self.launch((1, "run", good, "--quiet"), (1, "check", good), code=2)
        self.assertEqual(done.stderr.count("the ranks do not share one run: their commands differ"), 1, done.stderr)


class Log(Ranks):
    def test_pictures_are_not_compressed_and_this_is_said_once(self):
        if not self.has_hdf5():
            self.skipTest("built without HDF5")
        deck = self.deck(FALL)
        words = ["--set", "output.every=30", "--set", "output.compression=true"]
        said = [self.run_ranks(ranks, deck, *words).stderr.count("pictures uncompressed") for ranks in (1, 3)]
        self.assertEqual(said, [0, 1])

    def test_balls_that_pass_each_other_are_told_once(self):
        """A law that waits for the touch, 0.2 m between centres, and a ball that flies 2 m a step."""
        balls = "".join(f'[[body]]\nshape = "disk"\nradius = 0.1\nposition = {place}\n'
                        for place in ([0.2, 0.0], [0.2, 3.0], [0.2, -3.0], [3.0, 3.0], [3.0, -3.0], [-4.74, 0.0]))  # fmt: skip
        deck = self.deck("[scene]\ngravity = [0.0, 0.0]\n" + COMMON.replace("friction = 0.3", 'kind = "VEL_SGR_CLB"') + balls
                         + "velocity = [2000.0, 0.0]\n")  # fmt: skip
        for ranks in (1, 3):
            said = self.run_ranks(ranks, deck, "--set", "time.steps=5").stderr
            self.assertEqual(said.count("step 3: bodies 1 and 6 pass through each other, at 2.00E+03 m/s"), 1, said)
            self.assertEqual(said.count("warning"), 1, said)
            self.assertEqual(self.run_json()["passings"], 1)

    def test_said_once(self):
        printed = self.launch((4, "run", self.deck(PRESSED))).stdout
        lines = [line for line in printed.splitlines() if line.strip()]
        self.assertEqual(len(lines), len(set(lines)), printed)
        for said in ("scene      64 bodies", "ranks      4, split by boxes, coupled by dual", "done: 60 of 60 steps",
                     "  ranks  ", "  gluing  "):  # fmt: skip
            self.assertEqual(printed.count(said), 1, f"{said}\n{printed}")
        # No number has gone astray.
        self.assertIsNone(re.search(r"nan|inf\b|\*\*", printed, re.I), printed)
        self.assertEqual(self.run_json("deck.results")["ranks"], 4)
