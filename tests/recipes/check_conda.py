#!/usr/bin/env python3
"""Build the conda recipe by rattler-build with stand-ins for the packages that it names, where conda-forge is out of reach.

usage: check_conda.py PROGRAM FOLDER

A stand-in has the name and a version of a package, and brings what this machine has: compilers, CMake and ninja. The recipe is solved, its
script is run, with PROGRAM in place of a compilation, the package is made, and its tests are run from an environment of its own. What this
cannot show is whether conda-forge has these packages and whether the program links with them.
"""

import asyncio
import re
import shutil
import sys
from pathlib import Path

import rattler.index
import rattler_build

TOP = Path(__file__).resolve().parents[2]
RECIPE = TOP / "packaging/conda/recipe.yaml"
COMPILERS = {"c": "gcc", "cxx": "gxx", "fortran": "gfortran"}
TOOLS = ("cmake", "ninja")
# What the package must hold besides the program.
WANTED = ("bin/splitgrain", "share/man/man1/splitgrain.1", "share/bash-completion/completions/splitgrain",
          "share/splitgrain/postpro/splitgrain_postpro/viewer.html",
          "share/splitgrain/postpro/splitgrain_postpro/vendor/three.min.js", "share/splitgrain/input_decks/sliding_block.toml")  # fmt: skip


def requirements():
    """Names and least versions of the packages that the recipe names; a bound on the build string asks for that build."""
    text = RECIPE.read_text()
    lines = re.findall(r"^    - (?!.*compiler)(.+)$", text[text.index("requirements:") : text.index("tests:")], re.M)
    for line in lines:
        name, _, bound = line.partition(" ")
        yield name, re.search(r">=([\d.]+)", bound)[1] if ">=" in bound else "1.0", bound.split()[1].replace("*", "0") if bound.startswith("*") else "0"


def stand_in(channel, name, version, build, files, folder):
    """One package with these files (path: text), all of which are programs or settings of the environment."""
    place = folder / "files" / name
    for path, text in files.items():
        (place / path).parent.mkdir(parents=True, exist_ok=True)
        (place / path).write_text(text)
        (place / path).chmod(0o755)
    place.mkdir(parents=True, exist_ok=True)
    rattler_build.assemble_package(name, version, "linux-64", build, channel / "linux-64", files_dir=place, license="0BSD")


async def index(channel):
    """List the packages of the channel."""
    await rattler.index.index_fs(channel)


def main(program, folder):
    folder = Path(folder).resolve()
    shutil.rmtree(folder, ignore_errors=True)
    channel, output = folder / "channel", folder / "output"
    for path in (channel / "linux-64", channel / "noarch", output):
        path.mkdir(parents=True)
    named = list(requirements())
    for name, version, build in named:
        files = {f"bin/{name}": f'#!/bin/sh\nexec "{shutil.which(name)}" "$@"\n'} if name in TOOLS else {}
        stand_in(channel, name, version, build, files, folder)
    settings = f'export CMAKE_ARGS="-DSPLITGRAIN_BUILT={program}"\n'
    for name in COMPILERS.values():
        stand_in(channel, f"{name}_linux-64", "12.2", "0", {f"etc/conda/activate.d/{name}.sh": settings}, folder)

    asyncio.run(index(channel))
    compilers = rattler_build.VariantConfig({f"{language}_compiler": [name] for language, name in COMPILERS.items()})
    tools = rattler_build.ToolConfiguration(test_strategy="native")
    for variant in rattler_build.Stage0Recipe.from_file(RECIPE).render(compilers):
        variant.run_build(tools, output, [channel.as_uri()])
    made = next((output / "linux-64").glob("splitgrain-*.conda"))
    package = rattler_build.Package.from_file(made)
    missing = [path for path in WANTED if path not in map(str, package.files)]
    if missing or len(package.depends) < 5:
        sys.exit(f"check_conda: {made.name} lacks {', '.join(missing) or 'what it needs to run'}")
    print(f"{made.name}: {len(package.files)} files, {len(named) + len(COMPILERS)} stand-ins; needs {', '.join(package.depends)}")
    print("1 passed, 0 failed")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
