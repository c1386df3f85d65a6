"""Pictures as VTK (>= 9.3) reads them, and checks of them that are counted."""

import sys

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

failures = []


def check(holds, what):
    if not holds:
        failures.append(what)
        print("FAILED:", what)


def finish(folder):
    """Say how many checks failed; exit code 1 where any did."""
    print(f"VTK {vtk.VTK_VERSION}, {folder}: {len(failures)} failed")
    sys.exit(1 if failures else 0)


def times_of(reader, path):
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    return reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or ()


def grid_at(reader, time):
    """The grid of a time, read through the pipeline as ParaView does."""
    reader.UpdateTimeStep(time)
    grid = reader.GetOutputDataObject(0)
    while not grid.IsA("vtkDataSet"):  # one part, or one step of a collection
        grid = grid.GetBlock(0) if grid.IsA("vtkMultiBlockDataSet") else grid.GetPartition(0)
    return grid


def points_of(grid):
    return vtk_to_numpy(grid.GetPoints().GetData()) if grid.GetNumberOfPoints() else np.zeros((0, 3))
