#!/usr/bin/python3
"""Coarse-grained fields from outside: mass, momentum and stress of all cells against the record, a lattice, an affine flow, restarts
and ranks; needs numpy and h5py, and with vtk (>= 9.3) compares what that reads.

Usage: check_coarse_graining.py PROGRAM [LAUNCHER]
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "postpro"))
from splitgrain_postpro import Results  # noqa: E402

START = """[scene]
dimension = {d}
{more}
[time]
step = 1e-3
steps = {steps}
[solver]
criterion = "e8"
tolerance = {tolerance}
[output]
record_every = 1
[[material]]
name = "stone"
density = 2500.0
[[law]]
friction = 0.3
"""
# Rounding of sums over some thousand cells.
ROUNDING = 1e-11
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "TMPDIR"} | {
    "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
program, launcher = str(Path(sys.argv[1]).resolve()), sys.argv[2] if len(sys.argv) > 2 else None


def start(d, steps, tolerance=1e-8, more=""):
    return START.format(d=d, steps=steps, tolerance=tolerance, more=more)


def run(place, text, output, *words, ranks=1):
    (place / "deck.toml").write_text(text)
    command = [program, "run", "deck.toml", "--output", output, "--force", "--quiet", *words]
    if ranks > 1:
        command = [launcher, "--oversubscribe", "-n", str(ranks), *command]
    done = subprocess.run(command, cwd=place, capture_output=True, text=True, env=ENVIRONMENT, timeout=300)
    assert done.returncode == 0, done.stderr
    return Results(place / output)


def near(got, wanted, within, what):
    error = np.max(np.abs(np.asarray(got) - np.asarray(wanted)))
    assert error <= within, f"{what}: {np.asarray(got).flat[0]} is not {np.asarray(wanted).flat[0]}, off by {error:.2e}, within {within:.2e}"
    print(f"ok  {what}: off by {error:.1e}")


def shaken(d, steps=60, kernel="gaussian", sample_every=0):
    """Grains in a shaken box, and a grid that holds all of them with the reach of the kernel."""
    if d == 3:
        box = '[[container]]\nsize = [0.3, 0.3, 0.5]\n[[drive]]\nbody = "box.floor"\ncomponent = "z"\n'
        grains = '[[sample]]\nshape = "sphere"\nbox = [0.0, 0.0, 0.01, 0.3, 0.3, 0.3]\ncount = 40\nradius = [0.02, 0.03]\n'
        field = "box = [-0.2, -0.2, -0.2, 0.5, 0.5, 0.6]\ncells = [20, 16, 22]\n"
    else:
        box = "".join(f'[[wall]]\nname = "{name}"\nfrom = {a}\nto = {b}\nthickness = 0.1\n' for name, a, b in (
            ("floor", [-0.1, -0.05], [0.6, -0.05]), ("left", [-0.05, -0.1], [-0.05, 0.7]), ("right", [0.45, -0.1], [0.45, 0.7])))
        box += '[[drive]]\nbody = "floor"\ncomponent = "y"\n'
        grains = '[[sample]]\nkind = "random"\nbox = [0.0, 0.01, 0.4, 0.5]\ncount = 40\nradius = [0.02, 0.03]\n'
        field = "box = [-0.3, -0.3, 0.7, 0.9]\ncells = [40, 45]\n"
    field = f'[[field]]\n{field}every = 20\nsample_every = {sample_every}\nkernel = "{kernel}"\nwidth = 0.05\n'
    return start(d, steps) + box + "amplitude = 0.3\nfrequency = 20.0\n" + grains + field


def check_conservation(place):
    """Integrals over the grid are those of the grains: mass, momentum, volume, and the stress of the record times its box."""
    for d in (2, 3):
        for kernel in ("gaussian", "box"):
            results = run(place, shaken(d, kernel=kernel), "out")
            field, record = results.field(), results.record
            rows = np.searchsorted(record["step"], field.steps)
            assert list(field.steps) == [20, 40, 60] and np.allclose(field.times, record["time"][rows])
            name = f"{d}D, {kernel}: "
            mass = field["density"].sum((1, 2, 3)) * field.volume
            volume = field["solid_fraction"].sum((1, 2, 3)) * field.volume
            near(mass / volume, 2500, 2500 * ROUNDING, name + "mass over volume")
            near(mass, mass[0], mass[0] * ROUNDING, name + "mass stays")
            momentum = (field["density"][..., None] * field["velocity"]).sum((1, 2, 3)) * field.volume
            for a in range(d):
                near(momentum[:, a], record["momentum_" + "xyz"[a]][rows], ROUNDING * mass[0], name + "momentum " + "xyz"[a])
            stress = field["stress"].sum((1, 2, 3)) * field.volume
            box = volume / record["compactness"][rows]
            for a in range(d):
                for b in range(d):
                    wanted = record[f"stress_{'xyz'[a]}{'xyz'[b]}"][rows] * box
                    near(stress[:, 3 * a + b], wanted, ROUNDING * np.abs(stress).max(), name + f"stress {'xyz'[a]}{'xyz'[b]}")
            fabric = field["fabric"] * field["contact_density"][..., None]
            counted = fabric.sum((1, 2, 3))
            near(counted[:, 0] + counted[:, 4] + counted[:, 8], field["contact_density"].sum((1, 2, 3)),
                 ROUNDING * counted.max(), name + "trace of the fabric")


def check_lattice(place):
    """Columns of disks, two diameters apart, each pressed by 2 kN per metre: away from its ends every cell has the stress
    10 kPa, the fabric of columns and the density of the lattice."""
    columns = '[[wall]]\nname = "floor"\nfrom = [-0.1, -0.05]\nto = [1.7, -0.05]\nthickness = 0.1\n'
    for i in range(8):
        for k in range(6):
            columns += f'[[body]]\nname = "d{i}{k}"\nshape = "disk"\nradius = 0.05\nposition = [{0.05 + 0.2 * i}, {0.05 + 0.1 * k}]\n'
        columns += f'[[drive]]\nbody = "d{i}5"\ncomponent = "y"\nkind = "force"\nvalue = -2000.0\n'
    # The box is as wide as two columns are apart, and as high as two disks: every cell sees the same number of lattice points wherever its centre lies.
    field = '[[field]]\nbox = [0.3, 0.2, 1.1, 0.4]\ncells = [40, 10]\nevery = 2\nkernel = "box"\nwidth = 0.1\n'
    results = run(place, start(2, 4, 1e-12, "gravity = [0.0, 0.0]").replace("0.3", "0.0") + columns + field, "lattice")
    assert results.run["unconverged_steps"] == 0
    field = results.field()
    near(field["stress"][-1, ..., 4], 1e4, 1e4 * 1e-8, "lattice: stress_yy")
    near(field["stress"][-1, ..., 0], 0, 1e4 * 1e-8, "lattice: stress_xx")
    near(field["fabric"][-1, ..., 4], 1, 1e-12, "lattice: fabric_yy")
    near(field["density"][-1], 2500 * np.pi / 8, 2500 * 1e-11, "lattice: density")


def check_flow(place):
    """Grains that fly apart by v = (2 x, -3 z, ...): the gradient in the middle of the grid is that of the flow."""
    grains = "".join(f'[[body]]\nshape = "sphere"\nradius = 0.02\nposition = [{0.1 * i}, {0.1 * j}, {0.1 * k}]\n'
                     f'velocity = [{0.2 * i}, {0.5 * 0.1 * i}, {-0.3 * k}]\n' for i in range(12) for j in range(12) for k in range(12))
    field = '[[field]]\nbox = [0.2, 0.2, 0.2, 0.9, 0.9, 0.9]\ncells = [7, 7, 7]\nevery = 1\nkernel = "gaussian"\nwidth = 0.08\n'
    results = run(place, start(3, 1, 1e-8, "gravity = [0.0, 0.0, 0.0]") + grains + field, "flow")
    gradient = results.field()["velocity_gradient"][0]
    # The lattice is coarse for its kernel: means over it are those of the flow up to a ripple.
    near(gradient[2:5, 2:5, 2:5], np.array([2, 0, 0, 0.5, 0, 0, 0, 0, -3.0]), 0.06, "flow: velocity gradient")


def check_restart_and_ranks(place):
    """A run that goes on between two grids, amid samples, writes the very same arrays; so do ranks that hold the same subdomains."""
    for d in (2, 3):
        text = shaken(d, sample_every=3)
        words = ("--set", "restart.every=31", "--set", "restart.at_end=false")
        straight = run(place, text, "out", *words).field()
        wanted = {name: straight[name] for name in straight.names}
        single = run(place, shaken(d), "single").field()
        assert not np.array_equal(single["density"], wanted["density"]), "samples are averaged"
        field = run(place, text, "out", *words, "--restart", "out/restart_a.h5").field()
        assert list(field.steps) == [20, 40, 60]
        for name, values in wanted.items():
            assert np.array_equal(field[name], values), name
        print(f"ok  {d}D: restart bit for bit")
        if not launcher:
            continue
        fields = [run(place, text, f"parts{ranks}", "--set", "partition.parts=3", ranks=ranks).field() for ranks in (1, 3)]
        for name in wanted:
            assert np.array_equal(fields[0][name], fields[1][name]), name
            near(fields[0]["density"].sum(), wanted["density"].sum(), ROUNDING * wanted["density"].sum(), f"{d}D: parts, mass")
        print(f"ok  {d}D: three subdomains on one rank and on three")


def check_vtk(place):
    """VTK reads the same numbers, grid by grid."""
    try:
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
    except ImportError:
        print("--  no vtk: what it reads is not compared")
        return
    for d in (2, 3):
        field = run(place, shaken(d), "vtk").field()
        reader = vtk.vtkHDFReader()
        reader.SetFileName(str(field.path))
        reader.UpdateInformation()
        times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
        assert np.array_equal(times, field.times), times
        for i, time in enumerate(times):
            reader.UpdateTimeStep(time)
            image = reader.GetOutputDataObject(0)
            assert image.GetDimensions() == tuple(n + 1 for n in field.cells), image.GetDimensions()
            assert np.allclose(image.GetOrigin(), field.origin) and np.allclose(image.GetSpacing(), field.spacing)
            for name in field.names:
                found = vtk_to_numpy(image.GetCellData().GetArray(name))
                wanted = np.swapaxes(field[name][i], 0, 2)
                assert np.array_equal(found.reshape(wanted.shape), wanted), (name, i)
        print(f"ok  {d}D: VTK reads the same")


def check_mistakes(place):
    """A box without size, cells of another dimension."""
    good = shaken(2)
    for old, new, sentence in (("box = [-0.3, -0.3, 0.7, 0.9]\ncells", "box = [0.7, -0.3, -0.3, 0.9]\ncells", "least, then its largest"),
                               ("cells = [40, 45]", "cells = [40, 45, 3]", '"cells" are 2 numbers')):
        (place / "deck.toml").write_text(good.replace(old, new))
        done = subprocess.run([program, "check", "deck.toml"], cwd=place, capture_output=True, text=True, env=ENVIRONMENT)
        assert done.returncode == 2 and sentence in done.stderr, done.stderr
    print("ok  mistakes")


with tempfile.TemporaryDirectory() as folder:
    for check in (check_conservation, check_lattice, check_flow, check_restart_and_ranks, check_vtk, check_mistakes):
        check(Path(folder))
