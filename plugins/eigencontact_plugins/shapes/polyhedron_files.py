"""Files of surfaces: points, and faces with any number of corners."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, SceneError, require

__all__ = ["read_faces"]

IntArray = NDArray[np.intp]
TYPES = (".stl", ".ply", ".obj", ".off", ".vtk", ".vtu")
#: Points ``(n, 3)``; tables ``(faces, corners)`` of numbers of points, in order around each face; solid cells.
Content = tuple[FloatArray, list[IntArray], list[str]]


def read_faces(where: str, file: str) -> tuple[FloatArray, list[IntArray]]:
    """Points ``(n, 3)`` of a file, and tables ``(faces, corners)`` of the numbers of the corners, in order around each.

    Raises
    ------
    SceneError
        The file does not exist, is of an unknown kind, cannot be read, contains solid cells or no faces, or its faces
        refer to points that it does not contain.
    """
    path = Path(file)
    suffix = path.suffix.lower()
    require(path.is_file(), where, "file", file, "an existing file; a relative path counts from the scene's folder")
    require(suffix in TYPES, where, "file", file, f"a surface mesh of one of the types {', '.join(TYPES)}")
    try:
        with np.errstate(over="ignore"):  # meshio first tries to read the start of a text STL as a number of triangles
            points, faces, solid = {".off": _off, ".obj": _obj}.get(suffix, _by_meshio)(path)
    except (Exception, SystemExit) as problem:  # readers raise errors of many types
        reason = (str(problem).strip().splitlines() or [type(problem).__name__])[0]
        raise SceneError(f"{where}.file must be a readable mesh (got {file!r}); {reason}") from problem
    require(not solid, where, "file", file, f"a surface mesh without {', '.join(solid)} cells; extract its surface")
    require(len(faces) > 0, where, "file", file, "a mesh with triangles; it holds none")
    require(bool(np.isfinite(points).all()), where, "file", file, "a mesh of finite coordinates; some are not")
    numbers = np.concatenate([table.ravel() for table in faces])
    wrong = numbers[(numbers < 0) | (numbers >= len(points))]
    if wrong.size:
        rule = f"a mesh whose faces name its {len(points)} points; one names point number {wrong[0] + 1}"
        raise SceneError(f"{where}.file must be {rule} (got {file!r})")
    return points, faces


def _off(path: Path) -> Content:
    """Object file format: header, counts, points, faces; colours and normals may follow in a line."""
    lines = _lines(path)
    head = lines.pop(0)
    if not head[0].upper().endswith("OFF") or "4" in head[0]:
        raise ValueError(f"its first line must be OFF (got {' '.join(head)})")
    count, number = (int(text) for text in (head[1:] or lines.pop(0))[:2])
    if len(lines) < count + number:
        raise ValueError(f"it declares {count} points and {number} faces and has {len(lines)} lines for them")
    faces = [[int(text) for text in line[: 1 + int(line[0])]] for line in lines[count : count + number]]
    if any(len(face) != 1 + face[0] for face in faces):
        raise ValueError("a face has fewer corners than it declares")
    return _points(line[:3] for line in lines[:count]), _tables([face[1:] for face in faces]), []


def _obj(path: Path) -> Content:
    """Wavefront file: ``v x y z``, ``f a b c ...``; numbers count from 1, negative ones from the last point so far."""
    places: list[list[str]] = []
    faces: list[list[int]] = []
    for kind, *texts in _lines(path):
        if kind == "v":
            places.append(texts[:3])
        elif kind == "f":
            numbers = [int(text.split("/")[0]) for text in texts]
            faces.append([number + len(places) if number < 0 else number - 1 for number in numbers])
    return _points(places), _tables(faces), []


def _lines(path: Path) -> list[list[str]]:
    """Words of the lines of a file, without empty lines and comments after #."""
    rows = (line.partition("#")[0].split() for line in path.read_text(encoding="utf-8").splitlines())
    return [row for row in rows if row]


def _points(rows: Iterable[Sequence[str]]) -> FloatArray:
    return np.array(list(rows), dtype=float).reshape(-1, 3)


def _tables(faces: Iterable[Sequence[int]]) -> list[IntArray]:
    """Faces by their number of corners."""
    alike: dict[int, list[Sequence[int]]] = {}
    for face in faces:
        alike.setdefault(len(face), []).append(face)
    if min(alike, default=3) < 3:
        raise ValueError(f"a face must have three corners or more (got {min(alike)})")
    return [np.array(table, dtype=np.intp) for table in alike.values()]


def _by_meshio(path: Path) -> Content:
    import meshio  # type: ignore[import-untyped,unused-ignore]

    mesh = getattr(meshio, path.suffix[1:].lower()).read(str(path))
    flat = [block for block in mesh.cells if block.type in ("triangle", "quad") or block.type.startswith("polygon")]
    faces = [
        table
        for block in flat
        for table in ([block.data.astype(np.intp)] if isinstance(block.data, np.ndarray) else _tables(block.data))
    ]
    solid = sorted({block.type for block in mesh.cells if block.dim == 3})
    return np.asarray(mesh.points, dtype=float).reshape(-1, 3), faces, solid
