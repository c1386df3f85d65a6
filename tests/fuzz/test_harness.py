#!/usr/bin/env python3
"""The harness of fuzzers against programs whose end is known: each outcome must be found."""

import tempfile
import unittest
from pathlib import Path

from fuzz_harness import judge, run, worst

ENDS = {
    "exit 0": "clean",
    "exit 75": "clean",
    "echo 'deck.toml:3: error: unknown key' >&2; exit 2": "refused",
    "echo nothing >&2; exit 2": "wrong",
    "exit 9": "crashed",
    "kill -SEGV $$": "crashed",
    "echo 'At line 3: Fortran runtime error: end' >&2; exit 2": "crashed",
    "echo 'ERROR: AddressSanitizer: heap-use-after-free' >&2; exit 0": "crashed",
    "while :; do :; done": "hung",
    "mkdir results; echo '{\"time\": NaN}' > results/run.json": "wrong",
    "mkdir results; printf 'step,e1\\n1,  nan\\n' > results/record.csv; echo '{}' > results/run.json": "wrong",
}


class Harness(unittest.TestCase):
    def test_outcomes(self):
        for script, word in ENDS.items():
            with self.subTest(script), tempfile.TemporaryDirectory() as folder:
                ended = run("/bin/sh", ["-c", script], folder, seconds=1)
                self.assertEqual(judge(ended, Path(folder)).word, word)

    def test_limit_of_files(self):
        with tempfile.TemporaryDirectory() as folder:
            ended = run("/bin/sh", ["-c", "trap '' XFSZ; head -c 100000 /dev/zero > file"], folder, file_bytes=4096)
            self.assertNotEqual(ended.code, 0)
            self.assertLessEqual((Path(folder) / "file").stat().st_size, 4096)

    def test_worst(self):
        with tempfile.TemporaryDirectory() as folder:
            outcomes = [judge(run("/bin/sh", ["-c", script], folder)) for script in ("exit 0", "exit 9", "exit 3")]
        self.assertEqual(worst(outcomes).word, "crashed")


if __name__ == "__main__":
    unittest.main()
