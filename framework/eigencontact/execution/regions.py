"""Fields at the points of a region, and what is read off them, as they are stored."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.material import Material
from eigencontact.core.tensors import from_mandel, hydrostatic, principal, tresca, von_mises
from eigencontact.execution.runners import State
from eigencontact.planning.blocks import Block
from eigencontact.planning.plan import Plan
from eigencontact.planning.regions import RegionLattice
from eigencontact.results.records import RegionRecord
from eigencontact.scene.schema import StressRequest

__all__ = ["Region", "store_region", "strain_from_stress"]

FloatArray = NDArray[np.float64]

_SCALARS: dict[str, Callable[[FloatArray], FloatArray]] = {
    "von_mises": von_mises,
    "tresca": tresca,
    "principal": principal,
    "hydrostatic": hydrostatic,
}


class Region:
    """A region of a scene without contact: the fields of eigenstrain alone."""

    def __init__(self, _plan: Plan, block: Block) -> None:
        request, lattice = block.settings["request"], block.settings["lattice"]
        assert isinstance(request, StressRequest)
        assert isinstance(lattice, RegionLattice)
        self._request, self._lattice = request, lattice

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        store_region(state, self._request, self._lattice, state.inner[self._request.label])


def strain_from_stress(stress: FloatArray, body: Material) -> FloatArray:
    """Elastic Mandel strain of a Mandel stress ``(6, ...)``: Hooke's law, for an incompressible body too."""
    E, nu = body.young_modulus, body.poisson_ratio
    strain = (1.0 + nu) / E * stress
    strain[:3] -= nu / E * stress[:3].sum(axis=0)
    return np.asarray(strain)


def store_region(
    state: State, request: StressRequest, lattice: RegionLattice, fields: Mapping[str, FloatArray]
) -> None:
    """Add a region to the results of a step: the fields asked for, and with the stress the numbers read off it.

    Parameters
    ----------
    fields : mapping of str to array
        ``stress`` and ``strain`` as Mandel vectors ``(6, ...)``, ``displacement (3, ...)``, on the points of `lattice`.
    """
    stored: dict[str, FloatArray] = {}
    for name in request.fields:
        values = _cut(fields[name], request)
        stored[name] = values if name == "displacement" else from_mandel(values)
    mises: FloatArray | None = None
    if "stress" in request.fields:
        stress = _cut(fields["stress"], request)
        stored |= {name: _SCALARS[name](stress) for name in request.quantities}
        mises = stored.get("von_mises")
        mises = von_mises(stress) if mises is None else mises
    record = _record(request, lattice, stored)
    state.regions[request.label] = record
    if mises is None:
        return
    where = int(np.argmax(mises))
    largest = float(mises.flat[where])
    if largest >= state.scalars.get("max_von_mises", -1.0):
        depth = np.broadcast_to(_depth_of(record), mises.shape).flat[where]
        state.scalars["max_von_mises"], state.scalars["max_von_mises_depth"] = largest, float(depth)


def _cut(values: FloatArray, request: StressRequest) -> FloatArray:
    """Drop the axis of length one of a plane."""
    if request.shape != "plane":
        return values
    return np.squeeze(values, axis={"z": 1, "y": 2, "x": 3}[request.normal])


def _record(request: StressRequest, lattice: RegionLattice, fields: dict[str, FloatArray]) -> RegionRecord:
    coords: dict[str, FloatArray | float]
    if lattice.points is not None:
        dims: tuple[str, ...] = ("point",)
        coords = {name: lattice.points[:, i] for i, name in enumerate("xyz")}
    else:
        axes = {"z": lattice.depths, "y": lattice.y, "x": lattice.x}
        flat = request.normal if request.shape == "plane" else ""
        dims = tuple(name for name in "zyx" if name != flat)
        coords = {name: float(axis[0]) if name == flat else axis for name, axis in axes.items()}
    return RegionRecord(
        name=request.label, shape=request.shape, body=request.body, dims=dims, coords=coords, fields=fields
    )


def _depth_of(record: RegionRecord) -> FloatArray:
    depth = np.asarray(record.coords["z"], dtype=float)
    if record.dims and record.dims[0] == "z":
        return depth.reshape(-1, *[1] * (len(record.dims) - 1))
    return depth
