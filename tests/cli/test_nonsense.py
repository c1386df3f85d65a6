#!/usr/bin/env python3
"""Values of decks that make no sense: every key with wrong kinds and ranges, every key that another one switches off, angles in
degrees, keys that contradict each other.

usage: test_nonsense.py PROGRAM [unittest options]
"""

import re
import subprocess
import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / folder) for folder in ("support", "fuzz")]
from nonsense import base, read_reference, spoilt
from program_case import ProgramCase, take_program


class Nonsense(ProgramCase):
    def check_deck(self, text, *settings):
        """Exit code and messages of `check`."""
        (self.place / "deck.toml").write_text(text)
        words = [word for setting in settings for word in ("--set", setting)]
        done = subprocess.run([self.program, "check", "deck.toml", *words], cwd=self.place, capture_output=True, text=True,
                              timeout=self.timeout)
        return done.returncode, done.stderr

    def keys(self, dimension):
        """Path and key of all keys whose section stands in the deck of a dimension."""
        text = base(dimension)
        for heading, keys in read_reference(self.program).items():
            if heading in text:
                for key in keys:
                    yield f"{heading.strip('[]')}.{key.name}", key

    def test_decks_of_all_sections_are_right(self):
        for dimension in (2, 3):
            self.assertEqual(self.check_deck(base(dimension)), (0, ""))
            self.assertGreater(len(list(self.keys(dimension))), 100)

    def test_wrong_kinds_and_ranges_are_refused_by_name(self):
        """All mistakes of a deck are reported at once: each call has one wrong value for each of some keys."""
        for dimension in (2, 3):
            wrong = [(path, key, spoilt(key, dimension)) for path, key in self.keys(dimension)]
            for number in range(max(len(values) for _, _, values in wrong)):
                settings = [(path, key, values[number]) for path, key, values in wrong if number < len(values)]
                for first in range(0, len(settings), 90):
                    some = settings[first:first + 90]
                    code, said = self.check_deck(base(dimension), *(f"{path}={value}" for path, _, value in some))
                    self.assertEqual(code, 2)
                    for path, key, value in some:
                        self.assertRegex(said, rf'error: "({path}|{key.name})" ', f"{path} = {value} in {dimension}D")

    def test_keys_that_are_ignored(self):
        """With a warning, but where they say what the default says or are looked at."""
        found = 0
        for path, key in self.keys(2):
            unless = re.search(r"Ignored unless (\w+) is ((?:`[^`]*`(?: or )?)+)", key.meaning)
            if not unless:
                continue
            found += 1
            used = re.findall(r"`([^`]*)`", unless[2])
            section = path.rpartition(".")[0]
            switch = next(other for name, other in self.keys(2) if name == f"{section}.{unless[1]}")
            words = re.findall(r"`([^`]*)`", switch.value) or ["true", "false"]
            value = self.other_value(key)
            needs = ["report.structure=false"] if section == "report" else []
            for word in words:
                if (word, path) == ("coloured", "solver.order_seed") or (word, section) == ("true", "report"):
                    continue
                code, said = self.check_deck(base(2), *needs, f"{section}.{unless[1]}={word}", f"{path}={value}")
                is_said = f'"{key.name}" is ignored with {unless[1]} = ' in said
                self.assertEqual(is_said, word not in used, f"{path} = {value} with {unless[1]} = {word}: {code}, {said}")
                if key.default:
                    default = re.findall(r"`([^`]*)`", key.default)[0]
                    self.assertNotIn("ignored", self.check_deck(base(2), f"{section}.{unless[1]}={word}", f"{path}={default}")[1])
        self.assertGreater(found, 10)

    def other_value(self, key):
        """A value that is not the default."""
        default = (re.findall(r"`([^`]*)`", key.default) or [""])[0]
        if key.value.startswith("`"):
            return next(word for word in re.findall(r"`([^`]*)`", key.value) if f'"{word}"' != default)
        if key.value == "true or false":
            return "false" if default == "true" else "true"
        if key.value.startswith("a list of 4"):
            return "[0.0, 0.0, 1.0, 1.0]"
        return "1" if "integer" in key.value and default != "1" else "2" if "integer" in key.value else "0.5" if default != "0.5" else "0.6"

    def test_angles_in_degrees(self):
        text = subprocess.run([self.program, "reference"], capture_output=True, text=True, check=True).stdout
        found = 0
        for dimension in (2, 3):
            for path, key in self.keys(dimension):
                if not re.search(rf"^\| `{key.name}` \|[^|]*\| rad \|", text, re.M) or "at most" in key.value or "Only for" in key.meaning:
                    continue
                if f"Only in {'space' if dimension == 2 else 'the plane'}" in key.meaning:
                    continue
                found += 1
                value = "[0.0, 0.0, {}]" if key.value.startswith("a list") else "{}"
                code, said = self.check_deck(base(dimension), f"{path}={value.format('45.0')}")
                self.assertEqual(code, 0)
                self.assertRegex(said, rf'warning: "{key.name}" is 45.0 rad; angles are in radians')
                self.assertNotIn("radians", self.check_deck(base(dimension), f"{path}={value.format('6.28')}")[1])
        self.assertGreaterEqual(found, 8)

    def test_contradictions(self):
        """Exit code, line with caret, words; the same without the contradiction is right."""
        wrong = (
            (base(2, fixed="fixed = true\nvelocity = [1.0, 0.0]"), 2, "velocity = [1.0, 0.0]", "a fixed body has no velocity"),
            (base(2, fixed="fixed = true\nspin = 1.0"), 2, "spin = 1.0", "a fixed body has no spin"),
            (base(3, fixed="fixed = true\nspin = [0.0, 0.0, 1.0]"), 2, "spin = [0.0, 0.0, 1.0]", "a fixed body has no spin"),
            (base(2, wall="direction = [0.0, 1.0]"), 2, "direction = [0.0, 1.0]", 'has no meaning without the key "pressure"'),
            (base(2).replace('name = "rough"', "static_friction = 0.2\ndynamic_friction = 0.4\nname = \"rough\""), 2, "static_friction = 0.2",
             "is below the dynamic friction"),
            (base(2).replace('name = "rough"', "dynamic_friction = 0.4\nname = \"rough\""), 2, "dynamic_friction = 0.4",
             "the static friction, 0.0, is below"),
            (base(2).replace('name = "rough"', "friction = 30.0\nname = \"rough\""), 0, "friction = 30.0", '"friction" is 30.0; it is no angle'),
            (base(2).replace("[solver]", "[solver]\ncheck_every = 50\nmaximum_sweeps = 10"), 0, "check_every = 50",
             '"check_every" is larger than maximum_sweeps = 10'),
            (base(2).replace("[solver]", "[solver]\ntolerance = 1e49"), 2, "tolerance = 1e49", "must be at most 1"),
            (base(2).replace("[report]", "[report]\ntrace = true\ntrace_steps = [5, 11, 30]"), 0, "trace_steps = [5, 11, 30]",
             "2 of 3 steps to trace lie beyond the last step, 10"),
            (base(2).replace("[report]", "[report]\ntrace_steps = [5]"), 0, "trace_steps = [5]", '"trace_steps" is ignored with trace = false'),
        )
        for text, expected, line, words in wrong:
            with self.subTest(words):
                code, said = self.check_deck(text)
                self.assertEqual(code, expected, said)
                self.assertRegex(said, r"deck\.toml:\d+:\d+: " + ("error" if expected else "warning") + ".*" + re.escape(words))
                self.assertIn(f"  {line}\n", said)
                self.assertEqual(len(re.findall(r"(?:error|warning): ", said)), 1, said)
        right = (
            base(2, fixed="fixed = true\nvelocity = [0.0, 0.0]"),
            base(2).replace('name = "rough"', "static_friction = 0.4\ndynamic_friction = 0.2\nname = \"rough\""),
            base(2).replace("[solver]", "[solver]\nmaximum_sweeps = 10"),
            base(2).replace("[report]", "[report]\ntrace = true\ntrace_steps = [5, 10]"),
        )
        for text in right:
            self.assertEqual(self.check_deck(text), (0, ""))

    def test_tables_of_drives(self):
        deck = base(2).replace('component = "rotation"', 'component = "rotation"\nfile = "table.txt"')
        for table, expected, words in (
            ("0 1\n1 2\n", 0, ""),
            ("0 1\n1 2 3\n", 2, "table.txt:2:1: error: a third number stands here"),
            ("0.5 1\n1 2\n", 0, "the table begins at 0.5 s: its first value holds from the start"),
            ("secret 1\n", 2, "table.txt:1:1: error: a time and a value should stand here"),
        ):
            with self.subTest(words):
                (self.place / "table.txt").write_text(table)
                code, said = self.check_deck(deck)
                self.assertEqual(code, expected)
                self.assertIn(words, said)
                self.assertNotIn("secret", said)
        (self.place / "table.txt").write_text("0 1\n1 2\n")
        self.assertEqual(self.check_deck(deck.replace('file = "table.txt"', 'file = "table.txt"\namplitude = 1.0\nphase = 1.0')), (0, ""))

    def test_effective_decks_get_no_warning(self):
        for dimension in (2, 3):
            (self.place / "deck.toml").write_text(base(dimension))
            for setting in ("solver.maximum_sweeps=10", "solver.method=accelerated"):
                output = f"{dimension} {setting}"
                self.run_program("run", "deck.toml", "--quiet", "--set", "time.steps=0", "--set", setting, "--output", output)
                self.assertEqual(self.run_program("check", f"{output}/effective.toml").stderr, "")


if __name__ == "__main__":
    take_program()
    unittest.main()
