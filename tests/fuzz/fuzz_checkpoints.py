#!/usr/bin/env python3
"""Checkpoints whose bytes, datasets and attributes are spoilt. A run from one must refuse it, or give the answer that it gives from the
checkpoint as it was written; from a folder whose newest checkpoint is spoilt it must go on from the older one, and report that."""

import math
import re
import shutil
import sys

import h5py
import numpy as np
from fuzz_fclib import spoil_bytes
from fuzz_harness import SOURCE, Outcome, fuzz, judge, run

sys.path.insert(0, str(SOURCE / "tests/support"))
from checkpoints import replace, seal

SCENES = {"arch": 3, "polygons_settling": 2, "spheres_in_a_box": 3, "lattice_frictionless": 2, "rolling_sphere": 2, "biaxial": 1}
"""Decks, and how many steps of them lie between two checkpoints"""
REALS = ("time", "built", "bodies/position", "bodies/velocity", "bodies/angle", "bodies/orientation", "contacts/impulse")
WHOLE = {"contacts/contactor": [0, -1, 2**30], "contacts/law": [0, -1, 99], "contacts/status": [-1, 100, 2**20],
         "contacts/image": [128, 1000, -2**31]}
"""Whole numbers that no scene here has"""


def prepare(program, folder):
    """Per deck: the deck, its number of steps, and the answer from each of two checkpoints."""
    made = []
    for name, every in SCENES.items():
        deck = folder / f"{name}.toml"
        text = (SOURCE / "input_decks" / f"{name}.toml").read_text()
        deck.write_text(re.sub(r"^(\s*count\s*=)\s*\d+", r"\1 12", text, flags=re.M))
        words = ["run", deck, "--output", name, "--quiet", "--set", f"restart.every={every}", "--set", "output.every=0"]
        run(program, [*words, "--set", f"time.steps={2 * every}"], folder)
        steps, results = 3 * every, folder / name
        answers = {}
        for file in sorted(results.glob("restart_?.h5")):
            go_on(program, deck, steps, file, folder / "on")
            answers[file.name] = numbers(folder / "on")
            shutil.rmtree(folder / "on")
        if len(answers) == 2:
            made.append((deck, steps, results, answers))
    if not made:
        raise SystemExit("fuzz_checkpoints: no scene left two checkpoints")
    return made


def go_on(program, deck, steps, checkpoint, results):
    """Run from a checkpoint, or from the newest one of a folder."""
    return run(program, ["run", deck, "--restart", checkpoint, "--output", results, "--quiet", "--set", "restart.every=0",
                         "--set", "output.every=0", "--set", f"time.steps={steps}"], results.parent)


def numbers(results):
    """The answer of a run, digit by digit."""
    return (results / "numbers.tag").read_text() if (results / "numbers.tag").exists() else None


def try_case(rng, program, place, material):
    """One checkpoint, changed, alone or beside the older one."""
    deck, steps, results, answers = rng.choice(material)
    from_folder = rng.random() < 0.3
    # Of the two files the second was written last.
    name = "restart_b.h5" if from_folder else rng.choice(sorted(answers))
    shutil.copytree(results, place / "before")
    file = place / "before" / name
    (spoil_items if rng.random() < 0.4 else spoil_content)(rng, file)
    ended = go_on(program, deck, steps, place / "before" if from_folder else file, place / "results")
    outcome = judge(ended, place)
    if outcome.word == "refused" and from_folder and not re.search("does not fit the scene|another version", ended.err):
        return Outcome("wrong", f"the older checkpoint does not serve: {ended.err}")
    if outcome.word != "clean":
        return outcome
    answer = numbers(place / "results")
    if answer == answers[name]:
        return outcome
    if not from_folder or answer != answers["restart_a.h5"]:
        return Outcome("wrong", "another answer than from the checkpoint as it was written")
    return outcome if "warning" in ended.err and name in ended.err else Outcome("wrong", "goes on from the older checkpoint unreported")


def spoil_content(rng, file):
    """One to three bits turned over, bytes filled, or the end cut off."""
    data = file.read_bytes()
    if rng.random() < 0.6:
        spoilt = bytearray(data)
        for _ in range(rng.choice([1, 1, 1, 3])):
            spoilt[rng.randrange(len(spoilt))] ^= 1 << rng.randrange(8)
        file.write_bytes(spoilt)
    elif rng.random() < 0.5:
        # What disks leave behind most often: a block of zeros.
        size = rng.choice([16, 64, 256, 512, 4096])
        at = rng.randrange(len(data))
        file.write_bytes(data[:at] + bytes(len(data[at:at + size])) + data[at + size:])
    else:
        file.write_bytes(spoil_bytes(rng, data))


def spoil_items(rng, file):
    """A dataset or attribute that no run writes, under check sums that are right."""
    with h5py.File(file, "r+") as content:
        way = rng.randrange(4)
        if way == 0:
            spoil_attribute(rng, content)
        elif way == 1:
            set_one(rng, content, rng.choice([name for name in REALS if name in content]), [math.nan, math.inf, -math.inf])
        elif way == 2:
            name = rng.choice(sorted(WHOLE))
            set_one(rng, content, name, WHOLE[name])
        else:
            reshape(rng, content)


def spoil_attribute(rng, content):
    """An attribute that is an array, a text, gone, or out of its range."""
    name = rng.choice(["step", "serial", "format", "format_version", "deck_hash"])
    del content.attrs[name]
    values = [np.arange(rng.choice([0, 2, 10000]), dtype="i8"), np.full(500, b"a" * 50), "text", 1.5]
    if name == "step":
        values += [-1, 2**31, 2**62, 10**6]
    value = rng.choice([None, *values])
    if name != "deck_hash" and value is not None:
        content.attrs[name] = value
    elif name == "deck_hash":
        content.attrs[name] = np.full(500, b"a" * 50)


def set_one(rng, content, name, values):
    """One number of a dataset set to one of some values; nothing where it is empty."""
    item = content[name]
    if item.size:
        data = item[()]
        data.flat[rng.randrange(data.size)] = rng.choice(values)
        replace(item, data)


def reshape(rng, content):
    """A dataset with a row or a column more or less, of another kind, or gone."""
    name = rng.choice(["totals", *[name for name in (*REALS, *WHOLE) if name in content]])
    data = content[name][()]
    del content[name]
    way = rng.randrange(6)
    if way == 0:
        content[name] = data[:-1] if len(data) else np.zeros((1, *data.shape[1:]), data.dtype)
    elif way == 1:
        content[name] = np.concatenate([data, data[:1]]) if len(data) else np.zeros((2, *data.shape[1:]), data.dtype)
    elif way == 2:
        content[name] = np.repeat(data.reshape(len(data), -1), 2, axis=1) if data.size else np.zeros((3, 5))
    elif way == 3:
        content[name] = data.astype("S8") if data.size else np.zeros(4, "S8")
    elif way == 4:
        content.create_dataset(name, (2**30, *data.shape[1:]), data.dtype, chunks=(4096, *data.shape[1:]))
    if way < 3:
        seal(content[name])


if __name__ == "__main__":
    sys.exit(fuzz("checkpoints", __doc__, try_case, prepare))
