"""Small result folders, written by the page on formats rather than by the program under test's own reader."""

import json

import h5py
import numpy as np

COLUMNS = (
    "step,time,contacts,active_contacts,sweeps,contact_updates,converged,criterion,e1,e2,e8,violation,cpu_seconds,"
    "wall_seconds,cpu_predict,cpu_detect,cpu_assemble,cpu_solve,cpu_update,cpu_measure,cpu_output,kinetic_energy,"
    "potential_energy,external_work,drive_work,friction_loss,impact_loss,energy_closure,mean_penetration,"
    "max_penetration,volume_error,compactness,coordination,coordination_without_rattlers,single_contacts,"
    "double_contacts,triple_contacts,mean_velocity,max_velocity,inertia_number,pressure,floor_share"
).split(",")
CORNERS = 16


class Writer:
    """Append steps to a temporal unstructured grid; static=True repeats the topology of the first step."""

    def __init__(self, path):
        self.file = h5py.File(path, "w")
        root = self.file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([2, 0])
        root.attrs.create("Type", np.bytes_("UnstructuredGrid"))
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = np.int64(0)
        self.root, self.steps = root, steps

    def append(self, name, rows):
        """Add rows to a dataset below VTKHDF; returns where they start."""
        rows = np.asarray(rows)
        if name not in self.root:
            self.root.create_dataset(name, data=rows, maxshape=(None, *rows.shape[1:]), chunks=True)
            return 0
        data = self.root[name]
        start = data.shape[0]
        data.resize(start + len(rows), axis=0)
        data[start:] = rows
        return start

    def step(self, time, points, cells, cell_type, point_data=None, cell_data=None, field_data=None, static=False):
        """Write one step; no cells are written as one empty cell."""
        cell_data = cell_data or {}
        n_steps = int(self.steps.attrs["NSteps"])
        if not len(cells):
            points, cells, cell_type = np.empty((0, 3)), [[]], 0
            cell_data = {name: np.zeros((1, *np.shape(values)[1:])) for name, values in cell_data.items()}
        first_point = self.append("Points", points)
        if static and n_steps:
            part, first_cell, first_id = 0, 0, 0
        else:
            part = self.append("NumberOfPoints", [len(points)])
            self.append("NumberOfCells", [len(cells)])
            self.append("NumberOfConnectivityIds", [sum(map(len, cells))])
            ids = np.concatenate([np.asarray(cell, dtype=np.int64) for cell in cells])
            first_id = self.append("Connectivity", ids)
            self.append("Offsets", np.cumsum([0, *map(len, cells)]))
            types = np.broadcast_to(np.asarray(cell_type, dtype=np.uint8), len(cells))
            first_cell = self.append("Types", types)
        for group, data in (("PointData", point_data or {}), ("CellData", cell_data)):
            for name, values in data.items():
                start = self.append(f"{group}/{name}", values)
                self.append(f"Steps/{group}Offsets/{name}", [start])
        for name, value in (field_data or {}).items():
            start = self.append(f"FieldData/{name}", [value])
            self.append(f"Steps/FieldDataOffsets/{name}", [start])
            self.append(f"Steps/FieldDataSizes/{name}", [[1, 1]])
        self.append("Steps/PartOffsets", [part])
        self.append("Steps/NumberOfParts", [1])
        self.append("Steps/PointOffsets", [first_point])
        self.append("Steps/CellOffsets", [[first_cell]])
        self.append("Steps/ConnectivityIdOffsets", [[first_id]])
        self.append("Steps/Values", [time])
        self.steps.attrs["NSteps"] = np.int64(n_steps + 1)

    def close(self):
        self.file.close()


def packing(columns, rows, period=False):
    """Rows of touching disks between a floor and, unless periodic, two walls: centres, radii, pairs, forces."""
    x, y = np.meshgrid(np.arange(columns, dtype=float), np.arange(rows, dtype=float))
    centres = np.column_stack([(x + 0.5 * (y % 2)).ravel() + 0.5, (np.sqrt(3) / 2 * y).ravel() + 0.5])
    radii = np.full(len(centres), 0.5)
    length = float(columns) if period else 0.0
    pairs = []
    for i, centre in enumerate(centres):
        away = centres[i + 1 :] - centre
        if period:
            away[:, 0] -= length * np.round(away[:, 0] / length)
        pairs += [(i, i + 1 + j) for j in np.flatnonzero(np.hypot(*away.T) < 1.001)]
    forces = np.array([(rows + 1 - centres[[i, j], 1].mean()) * (1 + 0.8 * np.sin(3.7 * i + j)) for i, j in pairs])
    return centres, radii, np.array(pairs), forces, length


def write_results(folder, columns=12, rows=8, period=False, steps=3, contacts_from=1, finished=True, hollow=False, cell=None):
    """A folder of results: `steps` pictures every 10 steps, without contacts before picture `contacts_from`; of a periodic cell,
    whose height and tilts by picture `cell` gives."""
    folder.mkdir(parents=True, exist_ok=True)
    write_pictures(folder, packing(columns, rows, period), steps, contacts_from, hollow, cell)
    write_record(folder, 10 * (steps - 1))
    if finished:
        run = {"status": "done", "reason": "", "steps": 10 * (steps - 1), "time": 0.1 * (steps - 1), "bodies": columns * rows + 1, "sweeps": 1234,
               "unconverged_steps": 2, "worst_e1": None, "worst_e8": 4.2e-4, "cpu_seconds": 12.5, "version": "0.1.0"}
        (folder / "run.json").write_text(json.dumps(run))
    return folder


def write_pictures(folder, pack, steps, contacts_from, hollow, cell=None):
    """bodies, shapes and contacts.vtkhdf of a packing that falls and comes to rest."""
    centres, radii, pairs, forces, length = pack
    n = len(centres)
    width, height = centres[:, 0].max() + 0.5, centres[:, 1].max() + 0.5
    floor = np.array([[-0.5, -0.3], [width + 0.5, -0.3], [width + 0.5, 0], [-0.5, 0]])
    turn = 2 * np.pi * np.arange(CORNERS) / CORNERS
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    bodies, shapes, contacts = (Writer(folder / f"{name}.vtkhdf") for name in ("bodies", "shapes", "contacts"))
    for k in range(steps):
        time, drop = 0.1 * k, 0.2 * (steps - 1 - k)
        fields = {"step": 10 * k, "period": length}
        at = np.column_stack([centres[:, 0], centres[:, 1] + drop, np.zeros(n)])
        middle = np.vstack([at, [width / 2, -0.15, 0]])
        velocity = np.zeros((n + 1, 3))
        velocity[:n, 1] = -drop * (1 + 0.5 * np.sin(centres[:, 0]))
        start = middle + [0, 0.2 * k, 0]
        point_data = {"id": np.arange(1, n + 2), "radius": np.append(radii, 0.2), "mass": np.ones(n + 1),
                      "material": np.append(1 + np.arange(n) % 3, 4), "velocity": velocity,
                      "spin": np.zeros((n + 1, 3)), "angle": np.zeros(n + 1), "rank": np.zeros(n + 1, dtype=int),
                      "start_position": start, "displacement": middle - start,
                      "is_grain": np.append(np.ones(n), 0).astype(int)}
        cell_data = {} if cell is None else {"period_y": cell[0], "tilt": float(cell[1][k])}
        bodies.step(time, middle, np.arange(n + 1)[:, None], 1, point_data, field_data=fields | cell_data)
        outline = (at[:, None, :2] + radii[:, None, None] * circle).reshape(-1, 2)
        corners = np.vstack([outline, floor])
        cells = [*np.arange(CORNERS * n).reshape(n, CORNERS), CORNERS * n + np.arange(4)]
        types = [7] * (n + 1)
        body = np.arange(1, n + 2)
        if hollow:
            ring = [width / 2, height / 2] + 0.75 * max(width, height) * np.vstack([circle, circle[:1]])
            cells.append(len(corners) + np.arange(len(ring)))
            corners, types, body = np.vstack([corners, ring]), [*types, 4], np.append(body, n + 1)
        corners = np.column_stack([corners, np.zeros(len(corners))])
        shape_data = {"body": body, "material": np.ones(len(body), dtype=int), "kind": np.array(types)}
        shapes.step(time, corners, cells, types, cell_data=shape_data, field_data=fields, static=True)
        some = slice(None) if k >= contacts_from else slice(0, 0)
        chosen, force = pairs[some], forces[some]
        ends = middle[chosen].reshape(-1, 3)
        if length and len(ends):
            ends[1::2, 0] -= length * np.round((ends[1::2, 0] - ends[::2, 0]) / length)
        ways = ends[::2] - ends[1::2]
        contact_data = {"normal": ways / np.linalg.norm(ways, axis=1)[:, None], "point": (ends[::2] + ends[1::2]) / 2,
                        "force_normal": force, "force_tangential": 0.2 * force, "gap": np.zeros(len(force)),
                        "status": np.full(len(force), 2), "law": np.ones(len(force), dtype=int),
                        "candidate": chosen[:, 0] + 1, "antagonist": chosen[:, 1] + 1}
        contacts.step(time, ends, np.arange(2 * len(force)).reshape(-1, 2), 3, cell_data=contact_data,
                      field_data={**fields, "ncontacts": len(force)})
    for writer in (bodies, shapes, contacts):
        writer.close()


def write_record(folder, n_rows):
    """record.csv with curves of the kinds that runs give."""
    step = np.arange(1, n_rows + 1)
    time = 0.01 * step
    values = {name: np.zeros(n_rows) for name in COLUMNS}
    noise = np.random.default_rng(7).lognormal(0, 0.4, n_rows)
    settled = 1 - np.exp(-3 * time / time[-1])
    cpu = 0.02 * step
    values |= {"step": step, "time": time, "contacts": (2000 * settled).round(), "converged": np.ones(n_rows),
               "active_contacts": (1700 * settled).round(), "sweeps": (10 + 200 * settled * noise).round(),
               "e1": 1e-4 * noise, "e2": 1e-5 * noise, "e8": 8e-4 * np.minimum(noise, 1.2), "cpu_seconds": cpu,
               "cpu_detect": 0.1 * cpu, "cpu_assemble": 0.1 * cpu, "cpu_solve": 0.7 * cpu, "cpu_update": 0.05 * cpu,
               "kinetic_energy": 800 * settled * (1 - settled), "potential_energy": 5000 - 1000 * settled,
               "friction_loss": 500 * settled**2, "impact_loss": 300 * settled**2, "energy_closure": 1e-14 * noise,
               "max_velocity": 2 * np.ones(n_rows)}
    lines = [",".join(COLUMNS)] + [",".join(f"{values[name][k]:.8g}" for name in COLUMNS) for k in range(n_rows)]
    (folder / "record.csv").write_text("\n".join(lines) + "\n")


def write_traces(folder):
    """trace.csv of two steps, and trace_steps.csv of these and one without contacts."""
    points = ["step,time,iteration,contact_updates,cpu_seconds,e1,e2,e8"]
    for step in (10, 20):
        points += [f"{step},{0.01 * step},{k},{100 * k},{1e-3 * k},{10.0 ** (-k - 1)},{10.0 ** (-k - 2)},{10.0 ** -k}" for k in range(3)]
    (folder / "trace.csv").write_text("\n".join(points) + "\n")
    phases = ("predict", "detect", "assemble", "solve", "update", "measure", "output")
    steps = ["step,time,contacts,active_contacts,sweeps,contact_updates,converged,criterion,e1,e2,e8,cpu_seconds,"
             + ",".join(f"cpu_{phase}" for phase in phases)]
    for step in (10, 20, 30):
        seconds = [1e-3 * (step + i) for i in range(len(phases))]
        steps.append(f"{step},{0.01 * step},50,40,2,200,1,1e-3,1e-3,1e-4,1e-2,{sum(seconds)}," + ",".join(map(str, seconds)))
    (folder / "trace_steps.csv").write_text("\n".join(steps) + "\n")
