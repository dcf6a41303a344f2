"""Stress along straight cracks in a section of stored results."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.units import readable
from eigencontact.errors import SceneError
from eigencontact.postprocess.stress_cycle import CycleOfRegion
from eigencontact.solvers.edge_crack import EdgeCrack

if TYPE_CHECKING:
    from eigencontact.results.stored import Results

__all__ = ["CrackPath", "stress_on_path"]


@dataclass(frozen=True, eq=False)
class CrackPath:
    """A section below the surface in which cracks run.

    Attributes
    ----------
    region, axis : str
        Name of the region, and its axis along the surface, x or y.
    along, depths : (n,), (m,)
        Coordinates of its points [m].
    stress : (steps, 3, n, m)
        Stress along the axis, along z, and the shear of both [Pa].
    across : float
        Place of the section along the other axis of the surface [m].
    """

    region: str
    axis: str
    along: FloatArray
    depths: FloatArray
    stress: FloatArray
    across: float

    @classmethod
    def in_section(cls, cycle: CycleOfRegion) -> CrackPath:
        """Section of a stored region.

        Raises
        ------
        SceneError
            A region that is no plane of x and z, or of y and z.
        """
        names = [dim.removeprefix(f"{cycle.region}_") for dim in cycle.dims]
        axis = next((name for name in names if name in "xy"), "")
        if sorted(names) not in (["x", "z"], ["y", "z"]) or min(cycle.shape) < 2:
            raise SceneError(
                f"region must be a section in x and z, or y and z (got {cycle.region!r}, along {', '.join(names)}); "
                'store one with shape = "plane" and normal = "y"'
            )
        places = cycle.places.reshape(3, *cycle.shape)
        tensor = cycle.cycle.stress.reshape(-1, 6, *cycle.shape)
        # Mandel: xx, yy, zz, sqrt(2) (yz, xz, xy).
        rows = [0, 4] if axis == "x" else [1, 3]
        stress = np.stack([tensor[:, rows[0]], tensor[:, 2], tensor[:, rows[1]] / np.sqrt(2.0)], axis=1)
        if names[0] == "z":
            places, stress = places.swapaxes(1, 2), stress.swapaxes(2, 3)
        surface, other = "xy".index(axis), 1 - "xy".index(axis)
        return cls(cycle.region, axis, places[surface, :, 0], places[2, 0], stress, float(places[other].flat[0]))

    @property
    def spacing(self) -> float:
        """Largest distance between neighbouring points near the surface [m]."""
        return float(max(np.diff(self.along).max(), np.diff(self.depths)[0]))

    @property
    def first_depth(self) -> float:
        """Depth of the points next to the surface [m]."""
        return float(self.depths[0])

    @property
    def begins_at_surface(self) -> bool:
        """Whether the section begins within a spacing of its points from the surface."""
        return self.first_depth < self.spacing

    def mouth(self, place: Any) -> float:
        """Place of the mouth along the axis: a number, or the (x, y, z) of a hot spot.

        Raises
        ------
        SceneError
            No place, or one outside of the section.
        """
        if place is None:
            raise SceneError("at must be given, the place of the mouth along the section [m], or start, a hot spot")
        value = float(place if np.ndim(place) == 0 else place["xy".index(self.axis)])
        if not self.along[0] < value < self.along[-1]:
            ends = " and ".join(readable(float(end), "m") for end in (self.along[0], self.along[-1]))
            raise SceneError(f"at must lie within {self.region!r}, between {ends} (got {readable(value, 'm')})")
        return value

    def angle_of(self, normal: Any) -> float:
        """Inclination of a crack on a plane of a criterion, by the trace of the plane in the section; 0 without one.

        Raises
        ------
        SceneError
            A plane that has no trace to speak of, or one along the surface.
        """
        if normal is None:
            return 0.0
        across, down = float(normal["xy".index(self.axis)]), float(normal[2])
        if np.hypot(across, down) < 0.05:
            raise SceneError(
                f"angle must be given where the plane of the criterion lies in the section (normal {normal}, got None)"
            )
        return float(np.arctan(-down / across)) if across else 0.5 * np.pi

    def reach(self, mouth: float, crack: EdgeCrack) -> float:
        """Longest crack that stays in the section [m]."""
        sideways, down = crack.tangent
        room = (self.along[-1] - mouth) if sideways > 0 else (mouth - self.along[0])
        ends = [self.depths[-1] / down]
        if abs(sideways) > 1e-12:
            ends.append(room / abs(sideways))
        return float(min(ends))

    def contact_extent(self, dataset: Results) -> float | None:
        """Largest extent of the contact across the section over the history [m]; None where nothing tells."""
        other = "y" if self.axis == "x" else "x"
        if "pressure" not in dataset or dataset.sizes[other] < 2:
            return None
        loaded = np.asarray(dataset["pressure"].values) > 0
        rows = np.asarray(dataset[other].values)[loaded.any(axis=(0, 2 if self.axis == "x" else 1))]
        spacing = float(np.diff(np.asarray(dataset[other].values)).mean())
        return float(np.ptp(rows) + spacing) if rows.size else None


def stress_on_path(
    path: CrackPath, crack: EdgeCrack, mouth: float, lengths: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Normal and shear stress on cracks at the positions that `EdgeCrack` wants, ``(steps, lengths, positions)`` [Pa].

    Above the first and beside the last points stress is that of the nearest ones.
    """
    from scipy.interpolate import RegularGridInterpolator

    distance = lengths[:, None] * crack.positions
    x = np.clip(mouth + crack.tangent[0] * distance, path.along[0], path.along[-1])
    z = np.clip(crack.tangent[1] * distance, path.depths[0], path.depths[-1])
    steps = len(path.stress)
    values = np.moveaxis(path.stress.reshape(steps * 3, *path.stress.shape[2:]), 0, -1)
    at = RegularGridInterpolator((path.along, path.depths), values)(np.stack([x, z], axis=-1))
    along, down, shear = np.moveaxis(at, -1, 0).reshape(steps, 3, *distance.shape).swapaxes(0, 1)
    (tx, tz), (nx, nz) = crack.tangent, crack.normal
    normal = nx**2 * along + nz**2 * down + 2.0 * nx * nz * shear
    return normal, tx * nx * along + tz * nz * down + (tx * nz + tz * nx) * shear
