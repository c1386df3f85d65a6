"""Open pictures while a program writes them, and after that program was killed.

usage: check_live.py PROGRAM FOLDER
       PROGRAM is the unit test test_pictures, which called with a folder writes pictures there until it is killed.
"""
import subprocess
import sys
import time
from pathlib import Path

import h5py
import vtk

NAMES = ("bodies", "shapes", "contacts")


def whole_steps(path):
    """Number of steps of a file, all of whose rows must be there; they belong to an HDF5 file of any reader."""
    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        steps = root["Steps"]
        n = int(steps.attrs["NSteps"])
        if n == 0:
            return 0
        assert steps["Values"].shape[0] >= n, "times"
        part = steps["PartOffsets"][n - 1]
        points = steps["PointOffsets"][n - 1] + root["NumberOfPoints"][part]
        cells = steps["CellOffsets"][n - 1, 0] + root["NumberOfCells"][part]
        assert root["Points"].shape[0] >= points and root["Types"].shape[0] >= cells, "points or cells"
        for group, rows in (("PointData", root["NumberOfPoints"][part]), ("CellData", root["NumberOfCells"][part])):
            for name, array in root[group].items():
                assert array.shape[0] >= steps[f"{group}Offsets/{name}"][n - 1] + rows, name
                array[-1]  # can be read
        return n


def last_step_in_vtk(path):
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    last = reader.GetNumberOfSteps() - 1
    reader.SetStep(max(0, last))
    reader.Update()
    assert reader.GetOutputDataObject(0) is not None
    return last + 1


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    writer = subprocess.Popen([program, str(folder)])
    try:
        seen = []
        deadline = time.monotonic() + 60
        while len(set(seen)) < 20 and time.monotonic() < deadline:
            time.sleep(0.1)
            assert writer.poll() is None, "the writer ended by itself"
            if not all((folder / f"{name}.vtkhdf").exists() for name in NAMES):
                continue
            try:
                seen.append(min(whole_steps(folder / f"{name}.vtkhdf") for name in NAMES))
            except (OSError, KeyError, RuntimeError) as unlucky:  # caught the writer amid a flush
                print("seen amid a flush:", unlucky)
        assert len(set(seen)) >= 20, f"the number of steps did not grow: {seen}"
        assert seen == sorted(seen), "the number of steps shrank"
    finally:
        writer.kill()
        writer.wait()
    for name in NAMES:
        path = folder / f"{name}.vtkhdf"
        steps = whole_steps(path)
        assert steps >= seen[-1] and last_step_in_vtk(path) == steps, f"{name} after the kill"
        print(f"{name}: {steps} steps after the kill")
    print("0 failed")


if __name__ == "__main__":
    main()
