#!/usr/bin/env python3
"""Configure what the Spack package asks for, without Spack: its directives are read by stand-ins, its options given to CMake.

usage: check_spack.py FOLDER

For all variants on, all off and one off each, the options of `cmake_args` must give a build that uses the libraries of the variants, and
no others; the dependencies that hold then must be those of the libraries. What this cannot show is whether Spack builds these dependencies.
"""

import re
import subprocess
import sys
import types
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
RECIPE = TOP / "packaging/spack/package.py"
# Of each variant with a library: what Spack calls its package, and a part of the name of its file.
LIBRARIES = {"mpi": ("mpi", "libmpi"), "hdf5": ("hdf5", "hdf5"), "metis": ("metis", "libmetis."), "fftw": ("fftw", "libfftw3."),
             "suitesparse": ("suite-sparse", "libumfpack."), "qhull": ("qhull", "libqhull_r."), "lapack": ("lapack", "liblapack.")}  # fmt: skip


class Recipe:
    """The package with the directives that it used."""

    def __init__(self):
        self.variants, self.dependencies = {}, []
        module = types.ModuleType("spack.package")
        module.license = module.version = lambda *_, **__: None
        module.variant = lambda name, default, description: self.variants.update({name: default})
        module.depends_on = lambda spec, when="", type=None: self.dependencies.append((spec, when))
        module.CMakePackage = Package
        sys.modules |= {"spack": types.ModuleType("spack"), "spack.package": module}
        names = {}
        exec(compile(RECIPE.read_text(), RECIPE, "exec"), names)
        self.kind = names["Splitgrain"]

    def needed(self, chosen):
        """Names of the dependencies that hold for these variants."""
        for spec, when in self.dependencies:
            if all(chosen[name] == (sign == "+") for sign, name in re.findall(r"([+~])(\w+)", when)):
                yield re.match(r"[\w-]+", spec)[0]


class Package:
    """Base class of the package: options of CMake by variants."""

    run_tests = False

    def __init__(self, chosen):
        self.chosen = chosen

    def define(self, name, value):
        return f"-D{name}:BOOL={'ON' if value else 'OFF'}"

    def define_from_variant(self, name, variant):
        return self.define(name, self.chosen[variant])


def mistakes(recipe, chosen, folder):
    """What is wrong with a choice of variants."""
    words = ["cmake", "-S", TOP, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", *recipe.kind(chosen).cmake_args()]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        return [done.stderr.strip()]
    # Some libraries are linked, others opened on demand.
    linked = " ".join(re.findall(r"LINK_LIBRARIES = (.*)", (folder / "build.ninja").read_text()))
    linked += (folder / "generated/library_files.f90").read_text()
    needed = set(recipe.needed(chosen))
    found = []
    for variant, (package, word) in LIBRARIES.items():
        if (word in linked) != chosen[variant]:
            found.append(f"{variant} = {chosen[variant]}, but {word} is {'' if word in linked else 'not '}used")
        if (package in needed) != chosen[variant]:
            found.append(f"{variant} = {chosen[variant]}, but the package {package} is {'' if package in needed else 'not '}needed")
    return found


def main(folder):
    recipe, failed = Recipe(), 0
    if set(recipe.variants) != {*LIBRARIES, "python"}:
        sys.exit(f"check_spack: variants are {', '.join(recipe.variants)}")
    every = dict.fromkeys(recipe.variants, True)
    choices = {"all": every, "none": dict.fromkeys(every, False), **{f"without_{name}": every | {name: False} for name in ("mpi", "hdf5", "fftw")}}
    for name, chosen in choices.items():
        found = mistakes(recipe, chosen, Path(folder).resolve() / name)
        failed += bool(found)
        print(f"{name}: {'; '.join(found) or ', '.join(sorted(recipe.needed(chosen)))}")
    print(f"{len(choices) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
