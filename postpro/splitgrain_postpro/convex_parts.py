"""Divide the objects of an OBJ file into convex parts with CoACD [Wei2022], for the blocks `[[blocks]]` of decks.

An object that is convex stays as it is. The parts of another one are groups `convex_1`, `convex_2`, ... of it: the program joins
them to one rigid body. The hulls of the parts approximate the object: its corners may stand out or be cut by some percent of it.
"""

from pathlib import Path

import numpy as np

from .errors import ResultsError

# A vertex that stands out of the plane of a face by less, over the size of the object, lies in it.
FLAT = 1e-7


def split_mesh(path: Path, output: Path | None = None, threshold: float = 0.05) -> str:
    """Divide the objects of a file; returns a sentence about what was written."""
    if path.suffix.lower() != ".obj":
        raise ResultsError(f"{path} is no OBJ file: its name must end in .obj")
    if not 0.01 <= threshold <= 1:
        raise ResultsError(f"the threshold is a share from 0.01 to 1, not {threshold:g}")
    objects = read_obj(path)
    parts = {name: convex_parts(name, vertices, faces, threshold) for name, (vertices, faces) in objects.items()}
    output = output or path.with_suffix(".convex.obj")
    try:
        output.write_text(obj_text(parts))
    except OSError as error:
        raise ResultsError(f"cannot write {output}: {error.strerror or error}") from error
    divided = [name for name, found in parts.items() if len(found) > 1]
    return f"{output}: {len(parts)} objects, {len(divided)} of them divided into {sum(len(parts[name]) for name in divided)} convex parts"


def read_obj(path: Path) -> dict[str, tuple[np.ndarray, list[list[int]]]]:
    """Objects of a file by name: their vertices, and their faces as numbers of these from 0."""
    try:
        lines = path.read_text().replace("\\\n", " ").splitlines()
    except (OSError, ValueError) as error:
        raise ResultsError(f"cannot read {path}: {error}") from error
    vertices, faces, name = [], {}, path.stem
    for number, line in enumerate(lines, 1):
        word, *rest = line.split() or [""]
        try:
            if word == "v":
                vertices.append([float(x) for x in rest[:3]])
            elif word == "o" and rest:
                name = " ".join(rest)
            elif word == "f":
                corners = [int(corner.split("/")[0]) for corner in rest]
                corners = [corner - 1 if corner > 0 else len(vertices) + corner for corner in corners]
                faces.setdefault(name, []).append(corners)
        except ValueError as error:
            raise ResultsError(f"cannot read {path}: line {number}: {error}") from error
    if not faces:
        raise ResultsError(f"cannot read {path}: it holds no faces")
    if min(map(len, vertices)) < 3 or max(max(map(max, own)) for own in faces.values()) >= len(vertices):
        raise ResultsError(f"cannot read {path}: a vertex has no three coordinates, or a face has a vertex that is not there")
    objects = {}
    for key, own in faces.items():
        used, places = np.unique(np.concatenate(own), return_inverse=True)
        ends = np.cumsum([len(face) for face in own])
        objects[key] = np.array(vertices)[used], [list(map(int, face)) for face in np.split(np.ravel(places), ends[:-1])]
    return objects


def is_convex(vertices: np.ndarray, faces: list[list[int]]) -> bool:
    """Lie all vertices on one side of each face?"""
    size = np.ptp(vertices, axis=0).max()
    for face in faces:
        corners = vertices[face]
        normal = np.cross(corners - corners[0], np.roll(corners - corners[0], -1, axis=0)).sum(axis=0)
        length = np.linalg.norm(normal)
        if length <= (FLAT * size) ** 2:
            continue
        heights = (vertices - corners.mean(axis=0)) @ normal / length
        if heights.max() > FLAT * size and heights.min() < -FLAT * size:
            return False
    return True


def convex_parts(name: str, vertices: np.ndarray, faces: list[list[int]], threshold: float) -> list[tuple[np.ndarray, list[list[int]]]]:
    """The convex parts of an object; itself where it is convex."""
    if is_convex(vertices, faces):
        return [(vertices, faces)]
    try:
        import coacd
    except ModuleNotFoundError as error:
        raise ResultsError(f'the object "{name}" is not convex, and dividing it needs the Python package coacd (pip install coacd)') \
            from error
    triangles = np.array([[face[0], face[k], face[k + 1]] for face in faces for k in range(1, len(face) - 1)])
    coacd.set_log_level("error")
    found = coacd.run_coacd(coacd.Mesh(vertices, triangles), threshold=threshold)
    return [(np.asarray(own), [list(map(int, face)) for face in sides]) for own, sides in found]


def obj_text(parts: dict[str, list[tuple[np.ndarray, list[list[int]]]]]) -> str:
    """Objects as an OBJ file, several parts of one as groups."""
    lines, before = [], 1
    for name, found in parts.items():
        lines.append(f"o {name}")
        for number, (vertices, faces) in enumerate(found, 1):
            if len(found) > 1:
                lines.append(f"g convex_{number}")
            lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices, dtype=float).tolist()]
            lines += ["f " + " ".join(str(before + corner) for corner in face) for face in faces]
            before += len(vertices)
    return "\n".join(lines) + "\n"
