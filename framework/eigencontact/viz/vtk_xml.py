"""VTK files in XML, written without VTK: images, rectilinear grids, points and lines.

Arrays lie behind the XML as they are in memory, uncompressed: that is as small as what VTK writes by default
(compressed, then as text) and takes a hundredth of its time, and nothing of VTK is loaded, which takes half a second.

References
----------
VTK file formats, https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html: "XML file formats", with
appended data of raw encoding, each array behind its number of bytes (``header_type="UInt64"``).
"""

from __future__ import annotations

import html
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact import __version__

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.results.atomic import Sink

__all__ = ["COMPONENTS", "Mesh", "image", "lines", "points", "quoted", "rectilinear"]

#: Order in which VTK, and so ParaView, reads the six components of a symmetric tensor.
COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")
Arrays = dict[str, "NDArray[Any]"]


@dataclass(kw_only=True, slots=True)
class Mesh:
    """Mesh with its fields.

    Attributes
    ----------
    kind : str
        VTK's name of the mesh: ``"ImageData"``, ``"RectilinearGrid"``, ``"PolyData"``.
    whole, piece : mapping of str to str
        XML attributes of the mesh and of its only piece.
    geometry : mapping of str to arrays
        Sections of the piece that say where its points are and which of them are connected.
    point_data, cell_data : mapping of str to (n,) or (n, components) array
        Fields; x counts fastest, then y, then z.
    tensors : set of str
        Fields of six components that are symmetric tensors, ordered as `COMPONENTS`.
    """

    kind: str
    whole: Mapping[str, str]
    piece: Mapping[str, str]
    geometry: Mapping[str, Arrays] = field(default_factory=dict)
    point_data: Arrays = field(default_factory=dict)
    cell_data: Arrays = field(default_factory=dict)
    tensors: set[str] = field(default_factory=set)

    @property
    def suffix(self) -> str:
        """Ending of the names of its files."""
        return {"ImageData": ".vti", "RectilinearGrid": ".vtr", "PolyData": ".vtp"}[self.kind]

    def write(self, sink: Sink) -> None:
        """Write the mesh into an empty file."""
        order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
        mark = " ".join(str(byte) for byte in f"{__version__}\0".encode())
        maker = f'<Array type="String" Name="eigencontact" NumberOfTuples="1" format="ascii">{mark}</Array>'
        appended: list[NDArray[Any]] = []
        sections = {**self.geometry, "PointData": self.point_data, "CellData": self.cell_data}
        text = [
            '<?xml version="1.0"?>',
            f'<VTKFile type="{self.kind}" version="1.0" byte_order="{order}" header_type="UInt64">',
            f"<{self.kind}{_attributes(self.whole)}>",
            f"<FieldData>{maker}</FieldData>",
            f"<Piece{_attributes(self.piece)}>",
            *(self._section(name, arrays, appended) for name, arrays in sections.items()),
            f"</Piece>\n</{self.kind}>",
            '<AppendedData encoding="raw">\n_',
        ]
        sink.write("\n".join(text).encode())
        for values in appended:
            sink.write(np.uint64(values.nbytes).tobytes())
            if values.nbytes:
                sink.write(values.data)
        sink.write(b"\n</AppendedData>\n</VTKFile>\n")

    def _section(self, name: str, arrays: Arrays, appended: list[NDArray[Any]]) -> str:
        """XML of one section; its arrays are appended to the binary data."""
        rows = []
        for key, values in arrays.items():
            attributes = {"type": _type(values.dtype), "Name": key}
            if values.ndim > 1:
                attributes["NumberOfComponents"] = str(values.shape[1])
            if key in self.tensors:
                attributes |= {f"ComponentName{n}": component.upper() for n, component in enumerate(COMPONENTS)}
            attributes |= {"format": "appended", "offset": str(sum(8 + before.nbytes for before in appended))}
            rows.append(f"<DataArray{_attributes(attributes)}/>")
            appended.append(np.ascontiguousarray(values, dtype=np.uint8 if values.dtype == bool else None))
        active = {"Scalars": next(iter(arrays))} if arrays and name in ("PointData", "CellData") else {}
        return "\n".join([f"<{name}{_attributes(active)}>", *rows, f"</{name}>"])


def image(size: Sequence[int], spacing: Sequence[float], origin: Sequence[float]) -> Mesh:
    """Evenly spaced points, (x, y, z): number, spacing and first point."""
    extent = _extent(size)
    root_attributes = {"WholeExtent": extent, "Origin": _joined(origin), "Spacing": _joined(spacing)}
    return Mesh(kind="ImageData", whole=root_attributes, piece={"Extent": extent})


def rectilinear(x: NDArray[Any], y: NDArray[Any], z: NDArray[Any]) -> Mesh:
    """All points of three axes."""
    extent = _extent((x.size, y.size, z.size))
    axes = {"Coordinates": {"x": x, "y": y, "z": z}}
    return Mesh(kind="RectilinearGrid", whole={"WholeExtent": extent}, piece={"Extent": extent}, geometry=axes)


def points(where: NDArray[Any]) -> Mesh:
    """Scattered points, (n, 3); each is a cell."""
    return _poly(where, "Verts", np.arange(len(where)), np.arange(1, len(where) + 1))


def lines(where: NDArray[Any]) -> Mesh:
    """One line through points, (n, 3)."""
    return _poly(where, "Lines", np.arange(len(where)), np.array([len(where)]))


def _poly(where: NDArray[Any], kind: str, connected: NDArray[Any], ends: NDArray[Any]) -> Mesh:
    piece = {"NumberOfPoints": str(len(where)), f"NumberOf{kind}": str(ends.size)}
    cells = {"connectivity": connected.astype(np.int64), "offsets": ends.astype(np.int64)}
    return Mesh(kind="PolyData", whole={}, piece=piece, geometry={"Points": {"points": where}, kind: cells})


def _extent(size: Sequence[int]) -> str:
    return " ".join(f"0 {n - 1}" for n in size)


def _joined(numbers: Sequence[float]) -> str:
    return " ".join(repr(float(number)) for number in numbers)


def quoted(value: str) -> str:
    """Value of an XML attribute, without the standard library's function, which loads network modules."""
    return f'"{html.escape(value)}"'


def _attributes(attributes: Mapping[str, str]) -> str:
    return "".join(f" {name}={quoted(value)}" for name, value in attributes.items())


def _type(dtype: Any) -> str:
    """VTK's name of a type of numbers."""
    kind = {"f": "Float", "i": "Int", "u": "UInt", "b": "UInt"}[dtype.kind]
    return f"{kind}{8 * dtype.itemsize}"
