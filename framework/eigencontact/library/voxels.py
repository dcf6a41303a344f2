"""Regions of a body from an array of whole numbers, with a material for each number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.arrays import whole_array
from eigencontact.core.held_arrays import hold
from eigencontact.core.units import readable
from eigencontact.errors import require
from eigencontact.library.arguments import lengths

__all__ = ["Voxels"]

_SUBJECT = "Voxels"


class Voxels:
    """Content of a body voxel by voxel: an array of whole numbers, and a table of their materials.

    Parameters
    ----------
    labels : (nz, ny, nx) of int
        Number of each voxel; z points into the body. 0 is the material of the body.
    spacing : float or (float, float, float)
        Edges (dx, dy, dz) of a voxel [m], or one for all; text with a unit is accepted.
    materials : mapping of int to mapping or component
        By number: a constitutive law, ``{"young_modulus": "400 GPa", "poisson_ratio": 0.2}``, ``{"type": "j2", ...}``,
        ``{"void": True}`` or a law of `make`; an ``"eigenstrain"`` (a number, three, or a 3 x 3 matrix), which expands;
        or both. Every number in `labels` but 0 needs one.
    origin : (float, float, float), optional
        Corner of lowest x, y and z of the first voxel [m]; by default the array is centred in x and y, and begins at
        the surface.

    Raises
    ------
    SceneError
        An array that is not of whole numbers, a number without material, voxels above the surface.

    Notes
    -----
    A contact divides the body into cells of the width of its window's cells and, by default, of the height of the
    voxels. If the faces of cells and voxels coincide, the discretisation is exact; other cells have volume fractions.

    Examples
    --------
    >>> import numpy as np, eigencontact as ec
    >>> labels = np.zeros((8, 8, 8), dtype=int)
    >>> labels[2:4, 3:5, 3:5] = 1
    >>> ec.Voxels(labels, "0.5 um", {1: {"young_modulus": "400 GPa", "poisson_ratio": 0.2}})
    Voxels(8 x 8 x 8 of 500 nm, materials 1)
    """

    def __init__(
        self,
        labels: ArrayLike,
        spacing: float | str | Sequence[float | str],
        materials: Mapping[int, Any],
        *,
        origin: Sequence[float | str] | None = None,
    ) -> None:
        rule = "an array (nz, ny, nx) of whole numbers"
        array = whole_array(labels, _SUBJECT, "labels", rule)
        require(array.ndim == 3 and array.size > 0, _SUBJECT, "labels", array.shape, rule)
        require(isinstance(materials, Mapping), _SUBJECT, "materials", materials, "a mapping of numbers to materials")
        numbers = sorted(set(np.unique(array).tolist()) - {0})
        lacking = [number for number in numbers if number not in materials]
        require(not lacking, _SUBJECT, "materials", sorted(materials), f"given for each number but 0, so for {lacking}")
        self.spacing = lengths(spacing, 3, _SUBJECT, "spacing")
        _, ny, nx = array.shape
        dx, dy, _ = self.spacing
        corner = (-0.5 * nx * dx, -0.5 * ny * dy, 0.0)
        self.origin = corner if origin is None else lengths(origin, 3, _SUBJECT, "origin", positive=False)
        require(self.origin[2] >= 0, _SUBJECT, "origin", self.origin, "at a depth z of 0 or more [m]")
        self._tables = {number: _table_of(number, materials[number]) for number in numbers}
        self._image = hold(labels=array)

    @property
    def labels(self) -> NDArray[np.int32]:
        """Number of each voxel, (nz, ny, nx), read-only."""
        return self._image["labels"]

    def tables(self, body: int) -> list[dict[str, Any]]:
        """Tables ``[[inclusions]]`` of a scene, one for each number."""
        place = {"type": "voxels", "file": self._image.name, "spacing": self.spacing, "origin": self.origin}
        suffix = "" if body == 1 else " above"  # names in a scene are unique
        return [
            {"name": f"voxels {number}{suffix}", "body": body, **place, "value": number, **table}
            for number, table in self._tables.items()
        ]

    def __repr__(self) -> str:
        edges = " x ".join(dict.fromkeys(readable(edge, "m") for edge in self.spacing))
        shape = " x ".join(map(str, self.labels.shape[::-1]))
        return f"{_SUBJECT}({shape} of {edges}, materials {', '.join(map(str, self._tables)) or 'none'})"


def _table_of(number: int, description: Any) -> dict[str, Any]:
    """Eigenstrain and material of the table of a number."""
    rule = "a table of a constitutive law, of an eigenstrain, or of both; or a law of make()"
    good = (isinstance(description, Mapping) and len(description) > 0) or (
        is_dataclass(description) and not isinstance(description, type)
    )
    require(good, _SUBJECT, f"materials[{number}]", description, rule)
    if not isinstance(description, Mapping):
        return {"material": description}
    material = {name: value for name, value in description.items() if name != "eigenstrain"}
    table = {"eigenstrain": description["eigenstrain"]} if "eigenstrain" in description else {}
    return table | ({"material": material} if material else {})
