#!/usr/bin/env python3
"""All options of the command line that take numbers, with all malformed words, and all switches with values.

usage: test_options.py PROGRAM [unittest options]
"""

import random
import subprocess
import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / folder) for folder in ("support", "fuzz")]
from option_words import CALLS, MALFORMED, TINY, call_with, fault_of_number, list_options, word
from program_case import ProgramCase, take_program


class Options(ProgramCase):
    def setUp(self):
        super().setUp()
        (self.place / "tiny.toml").write_text(TINY)
        self.numbers, self.switches = list_options(self.program)

    def call(self, words):
        done = subprocess.run([self.program, *words], cwd=self.place, capture_output=True, text=True, timeout=self.timeout)
        return done.returncode, done.stderr

    def test_the_help_is_read_as_it_is_written(self):
        expected = {("run", "walltime"), ("bench", "contacts"), ("partition", "parts"), ("solve", "tolerance")}
        self.assertLessEqual(expected, {option[:2] for option in self.numbers})
        self.assertIn(("run", "quiet"), self.switches)

    def check_number(self, option, value):
        self.assertEqual(fault_of_number(option, value, *self.call(call_with(*option[:2], value))), "", f"{option} {value!r}")

    def test_malformed_numbers_are_refused_by_name(self):
        """Whole numbers and others have one reader each: it gets every word, by one option after the other, and every option some."""
        for is_whole in (True, False):
            options = [option for option in self.numbers if option[2] == is_whole]
            self.assertLess(len(options), len(MALFORMED) // 3)
            for option in options:
                self.check_number(option, "12")
            for i, value in enumerate(MALFORMED):
                self.check_number(options[i % len(options)], value)

    def test_random_numbers(self):
        rng = random.Random(14)
        for _ in range(50):
            self.check_number(rng.choice(self.numbers), word(rng))

    def test_switches_refuse_values(self):
        for command, name in self.switches:
            for value in ("1", "yes", "/"):
                code, said = self.call([*CALLS[command], f"--{name}={value}"])
                self.assertEqual(code, 2)
                self.assertIn(f"option --{name} takes no value", said)


if __name__ == "__main__":
    take_program()
    unittest.main()
