"""Recipes agree with each other, with what `start` installs, and with the options and the version of CMake."""

import ast
import re
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
DOCKER, APPTAINER = TOP / "Dockerfile", TOP / "packaging/splitgrain.def"
SPACK, CONDA = TOP / "packaging/spack/package.py", TOP / "packaging/conda/recipe.yaml"
CMAKE = (TOP / "CMakeLists.txt").read_text()
OPTIONS = set(re.findall(r"^option\((\w+)", CMAKE, re.M)) | {"BUILD_TESTING", "CMAKE_BUILD_TYPE"}
# What Python draws with, and what runs without a build need not have.
FOR_PYTHON = {"python3", "python3-h5py", "python3-matplotlib", "python3-numpy", "python3-pandas"}


def debian_packages(path):
    """Packages that a recipe installs."""
    text = re.sub(r"\\\n", " ", path.read_text())
    return set(re.search(r"apt-get install -y --no-install-recommends\s+([^&\n]*)", text)[1].split())


def cmake_commands(path):
    """The three calls of CMake."""
    return [" ".join(words.split()) for words in re.findall(r"cmake (?:-S|--build|--install)[^&\n]*", re.sub(r"\\\n", " ", path.read_text()))]


def test_containers_have_the_packages_of_start_and_the_same_commands():
    start = (TOP / "start").read_text()
    listed = start[start.index("missing_for_build()") : start.index("# The Python that has")]
    wanted = set(re.findall(r"echo ([a-z0-9+-]+)", listed)) - {"libhdf5-dev"}
    assert debian_packages(DOCKER) == debian_packages(APPTAINER) == wanted | FOR_PYTHON
    assert cmake_commands(DOCKER) == cmake_commands(APPTAINER) and len(cmake_commands(DOCKER)) == 3


def test_options_are_those_of_cmake():
    for path in (DOCKER, APPTAINER, CONDA):
        assert set(re.findall(r"-D(\w+)=", path.read_text())) <= OPTIONS, path
    tree = ast.parse(SPACK.read_text())
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    defined = {call.args[0].value: call for call in calls if isinstance(call.func, ast.Attribute) and call.func.attr.startswith("define")}
    assert defined.keys() <= OPTIONS and {f"SPLITGRAIN_{name}" for name in ("MPI", "HDF5", "METIS", "LAPACK")} <= defined.keys()
    variants = {call.args[0].value for call in calls if isinstance(call.func, ast.Name) and call.func.id == "variant"}
    assert {call.args[1].value for call in defined.values() if call.func.attr == "define_from_variant"} <= variants
    conditions = [item.value.value for call in calls for item in call.keywords if item.arg == "when"]
    assert {name for words in conditions for name in re.findall(r"[+~](\w+)", words)} <= variants


def test_versions_agree():
    version = re.search(r"^project\(splitgrain VERSION (\S+)", CMAKE, re.M)[1]
    assert f'version: "{version}"' in CONDA.read_text()
    for path in ("pyproject.toml", "CITATION.cff"):
        assert re.search(rf'^version\s*[=:]\s*"?{re.escape(version)}"?$', (TOP / path).read_text(), re.M), path
    minimum = re.search(r"^cmake_minimum_required\(VERSION ([\d.]+)", CMAKE, re.M)[1]
    assert f"cmake >={minimum}" in CONDA.read_text() and f"cmake@{minimum}:" in SPACK.read_text()
