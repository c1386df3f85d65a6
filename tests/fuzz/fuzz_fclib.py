#!/usr/bin/env python3
"""Contact problems in FCLIB files: dumps of small scenes whose bytes, datasets and numbers are spoilt, or that are stored in
another way. An answer that `solve` calls converged must have the error that it claims, computed here from W, q and friction."""

import json
import math
import re
import sys

import h5py
import numpy as np
from fuzz_harness import SOURCE, Outcome, fuzz, judge, run, worst

sys.path.insert(0, str(SOURCE / "tests" / "problems"))
from contact_problem import ContactProblem, errors  # noqa: E402

DECK_STEPS = {"arch": 4, "arch_of_stones": 3, "spheres_at_rest": 3}
NUMBERS = [0.0, -0.0, -1.0, 1e300, -1e300, 1e-300, 5e-324, 1e10, 1e-10, math.nan, math.inf, -math.inf, 3.0]
WHOLE = [0, 1, -1, 2, 3, 4, 7, 2**31 - 1, -2**31, 1000]
SOLVERS = ["nlgs", "nesterov", "auto", "accelerated", "proximal", "interior"]
TOLERANCE = 1e-6
HEADER_BYTES = 64
"""Bytes at the beginning of an object's header of HDF5, which say what it is made of"""


def prepare(program, folder):
    """Dumps of small scenes in both forms, at most some tens of contacts."""
    files = []
    for name, step in DECK_STEPS.items():
        text = (SOURCE / "input_decks" / f"{name}.toml").read_text()
        (folder / "deck.toml").write_text(re.sub(r"^(\s*count\s*=).*", r"\1 12", text, flags=re.M))
        run(program, ["run", "deck.toml", "--output", name, "--dump", str(step), "--set", f"time.steps={step}", "--quiet"], folder)
        files += sorted((folder / name).glob("dump-*.hdf5"))
    if not files:
        raise SystemExit("fuzz_fclib: no problem could be dumped")
    return [(path, path.read_bytes(), headers(path)) for path in files]


def headers(path):
    """Where the headers of all objects of a file begin, of the solution's twice: `solve --write --force` does without them, and once
    crashed where the library removed them."""
    with h5py.File(path) as file:
        names = []
        file.visit(names.append)
        return [h5py.h5o.get_info(file[name].id).addr for name in names + [name for name in names if name.startswith("solution")]]


def try_case(rng, program, place, material):
    """One file, changed, solved by one solver."""
    _, data, places = rng.choice(material)
    file = place / "problem.hdf5"
    way = rng.randrange(3)
    if way == 0:
        file.write_bytes(spoil_bytes(rng, data, places))
    else:
        file.write_bytes(data)
        with h5py.File(file, "r+") as content:
            form = next(name for name in ("fclib_local", "fclib_global") if name in content)
            (spoil_items if way == 1 else store_otherwise)(rng, content[form])
            for name in ("guesses", "solution"):
                if name in content and rng.random() < 0.5:
                    del content[name]
    words = ["solve", "problem.hdf5", "--solver", rng.choice(SOLVERS), "--tolerance", str(TOLERANCE), "--json", "--write", "--force",
             "--seconds", "3"]
    ended = run(program, words + (["--guess"] if rng.random() < 0.3 else []), place)
    outcome = worst([judge(ended), check_answer(file, ended)])
    if way == 2 and outcome.word == "refused":
        return Outcome("wrong", "a right problem is refused in another way of storing it")
    return outcome


def spoil_bytes(rng, data, places=()):
    """Bytes flipped, anywhere or in the headers of objects, cut off, or filled."""
    data = bytearray(data)
    is_header = len(places) > 0 and rng.random() < 0.5
    for _ in range(rng.choice([1, 1, 3, 20])):
        at = rng.choice(places) + rng.randrange(HEADER_BYTES) if is_header else rng.randrange(len(data))
        data[at] ^= 1 << rng.randrange(8)
    way = rng.randrange(6)
    if way == 0:
        return bytes(data[: rng.randrange(len(data))])
    if way == 1:
        at = rng.randrange(len(data))
        data[at:at + 64] = bytes([rng.choice([0, 255])]) * 64
    return bytes(data)


def datasets(group):
    """All datasets of a group that hold numbers."""
    found = []
    group.visititems(lambda _, item: found.append(item) if isinstance(item, h5py.Dataset) and item.dtype.kind in "iuf" else None)
    return found


def spoil_items(rng, group):
    """One to three datasets changed: numbers, sizes, types, or gone."""
    for _ in range(rng.randint(1, 3)):
        items = datasets(group)
        if not items:
            return
        item = rng.choice(items)
        name, values = item.name, item[()]
        way = rng.randrange(8)
        is_real = np.issubdtype(item.dtype, np.floating)
        if way <= 3 and np.size(values):
            values = np.array(values, copy=True)
            for _ in range(rng.choice([1, 1, 2, values.size])):
                values.flat[rng.randrange(values.size)] = rng.choice(NUMBERS if is_real else WHOLE)
            item[...] = values
            continue
        del group.file[name]
        flat = np.atleast_1d(values).ravel()
        if way == 4:
            group.file[name] = flat[: rng.randrange(flat.size + 1)]
        elif way == 5:
            group.file[name] = np.concatenate([flat, flat[:1]])
        elif way == 6:
            with np.errstate(all="ignore"):
                group.file[name] = rng.choice([flat.astype("f4"), flat.astype("i8"), flat.astype("S8"), flat.reshape(1, -1), 7])


def store_otherwise(rng, group):
    """The matrices of a group in another way of storing, which says the same."""
    for name in [name for name in group if isinstance(group[name], h5py.Group) and "nz" in group[name]]:
        matrix = group[name]
        rows, columns, values = triplets(matrix)
        shape = int(matrix["m"][0]), int(matrix["n"][0])
        order = list(range(len(values)))
        kind = rng.choice([0, -1, -2])
        rng.shuffle(order)
        rows, columns, values = rows[order], columns[order], values[order]
        if kind == 0:
            p, i, nz = columns, rows, len(values)
        else:
            major, minor = (columns, rows) if kind == -1 else (rows, columns)
            by_major = np.argsort(major, kind="stable")
            values, i = values[by_major], minor[by_major]
            p = np.concatenate([[0], np.cumsum(np.bincount(major, minlength=shape[1 if kind == -1 else 0]))])
            nz = kind
        for key, data in (("p", p), ("i", i), ("x", values), ("nz", [nz]), ("nzmax", [len(values)])):
            data_type = matrix[key].dtype
            del matrix[key]
            matrix[key] = np.asarray(data, dtype=data_type)


def triplets(matrix):
    """Rows, columns and values of a stored matrix."""
    nz, m, n = (int(matrix[key][0]) for key in ("nz", "m", "n"))
    p, i, x = (matrix[key][()] for key in "pix")
    if nz >= 0:
        return i[:nz], p[:nz], x[:nz]
    spread = np.repeat(np.arange(n if nz == -1 else m), np.diff(p))
    return (i, spread, x) if nz == -1 else (spread, i, x)


def check_answer(file, ended):
    """Wrong where an answer that counts as converged has another error than it claims, or is not finite."""
    line = next((line for line in ended.out.splitlines() if line.startswith("{")), None)
    if ended.code != 0 or line is None:
        return Outcome("clean")
    row = json.loads(line)
    if not row["converged"]:
        return Outcome("wrong", "exit code 0 without a converged answer")
    try:
        problem, r = read_solved(file)
    except (KeyError, OSError, ValueError, IndexError, TypeError):
        # A spoilt file of which `solve` needs less than is read here, such as a problem without contacts; or one with integers of
        # five bytes, which HDF5 reads and numpy does not.
        return Outcome("clean")
    if problem is None or problem.contacts == 0:
        return Outcome("clean")
    with np.errstate(all="ignore"):
        found = errors(problem, r)
    if not np.all(np.isfinite(r)):
        return Outcome("wrong", "an answer that counts as converged is not finite")
    if not found.e1 <= TOLERANCE * (1 + 1e-6) + found.rounding:
        return Outcome("wrong", f"converged to e1 {row['e1']}, but e1 is {found.e1:.2e}")
    return Outcome("clean")


def read_solved(file):
    """Problem and answer of a file in local form; no problem in another form."""
    with h5py.File(file) as content:
        if "fclib_local" not in content or "V" in content["fclib_local"]:
            return None, None
        group = content["fclib_local"]
        rows, columns, values = triplets(group["W"])
        w = np.zeros((int(group["W/m"][0]), int(group["W/n"][0])))
        np.add.at(w, (rows, columns), values)
        q, mu = (np.ravel(group["vectors"][name][()]) for name in ("q", "mu"))
        return ContactProblem(int(np.ravel(group["spacedim"])[0]), w, q, mu), np.ravel(content["solution/r"][()])


if __name__ == "__main__":
    sys.exit(fuzz("fclib", __doc__, try_case, prepare))
