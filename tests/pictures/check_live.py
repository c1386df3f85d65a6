"""Open pictures while a program writes them, and after that program was killed.

usage: check_live.py PROGRAM FOLDER
       check_live.py --steps FOLDER      print the number of whole steps of the pictures in a folder
       check_live.py --killed FOLDER N   check pictures of a program that was killed after it had written N steps
       PROGRAM is the unit test test_pictures, which called with a folder writes pictures there until it is killed.

Every look is a process of its own: a library that has met a file amid a flush may be in no state to read the next one.
"""
import subprocess
import sys
import time
from pathlib import Path

import h5py

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
    import vtk  # not for the looks at a growing file: it takes long to load

    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    last = reader.GetNumberOfSteps() - 1
    reader.SetStep(max(0, last))
    reader.Update()
    assert reader.GetOutputDataObject(0) is not None
    return last + 1


def look(*words):
    return subprocess.run([sys.executable, __file__, *map(str, words)], capture_output=True, text=True)


def check_killed(folder, least):
    for name in NAMES:
        path = folder / f"{name}.vtkhdf"
        steps = whole_steps(path)
        assert steps >= least and last_step_in_vtk(path) == steps, f"{name} after the kill"
        print(f"{name}: {steps} steps after the kill")


def watch(program, folder):
    """Numbers of whole steps seen while a program writes, which is then killed."""
    writer = subprocess.Popen([program, str(folder)])
    seen = []
    try:
        deadline = time.monotonic() + 90
        while len(set(seen)) < 20 and time.monotonic() < deadline:
            assert writer.poll() is None, "the writer ended by itself"
            if not all((folder / f"{name}.vtkhdf").exists() for name in NAMES):
                continue
            done = look("--steps", folder)
            if done.returncode == 0:
                seen.append(int(done.stdout))
            else:  # caught the writer amid a flush
                print("seen amid a flush:", (done.stderr.splitlines() or [f"exit {done.returncode}"])[-1])
    finally:
        writer.kill()
        writer.wait()
    return seen


def main():
    if sys.argv[1] == "--steps":
        print(min(whole_steps(Path(sys.argv[2]) / f"{name}.vtkhdf") for name in NAMES))
        return
    if sys.argv[1] == "--killed":
        check_killed(Path(sys.argv[2]), int(sys.argv[3]))
        return
    folder = Path(sys.argv[2])
    for _ in range(3):
        seen = watch(sys.argv[1], folder)
        assert len(set(seen)) >= 20, f"the number of steps did not grow: {seen}"
        assert seen == sorted(seen), "the number of steps shrank"
        done = look("--killed", folder, seen[-1])
        print(done.stdout, end="")
        # HDF5 writes a flush in parts: a kill between two of them may leave a file that its readers, or they themselves, break at.
        if done.returncode >= 0 and "OSError" not in done.stderr:
            break
        print("killed amid a flush:", (done.stderr.splitlines() or [f"exit {done.returncode}"])[-1])
    assert done.returncode == 0, done.stderr
    print("0 failed")


if __name__ == "__main__":
    main()
