"""Fields at the points of a region, by tractions, eigenstrain and bulk stress, and numbers from these fields."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.bulk import BULK_NAMES
from eigencontact.core.numbers import Number
from eigencontact.core.tensors import from_mandel, hydrostatic, principal, tresca, von_mises
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.block import Block, Cost, Run, Running
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.fields.cause import Cause
from eigencontact.model.interface import Interface
from eigencontact.model.model import Model
from eigencontact.model.regions import RegionLattice, region_lattice
from eigencontact.results.records import RegionRecord
from eigencontact.scene.schema import StressRequest

__all__ = ["Region", "RunningRegion", "region_of", "regions_of"]


_SCALARS: dict[str, Callable[[FloatArray], FloatArray]] = {
    "von_mises": von_mises,
    "tresca": tresca,
    "principal": principal,
    "hydrostatic": hydrostatic,
}

#: Function from an interface to the causes of the fields of a region.
CausesOf = Callable[[Interface | None], Iterator[Cause]]


class Region(Block):
    """Fields at the points of one region, by the tractions of a contact and by all eigenstrain of its body.

    A stored step has all input: the surface fields are the tractions, and the history has the eigenstrain.

    Parameters
    ----------
    request : StressRequest
        Requested quantities, limits and depths.
    lattice : RegionLattice
        Points of the region.
    causes : callable
        Function from an interface to the causes of the fields.
    interface : Interface or None
        None without a contact.
    requester : str, optional
        Observer that requested the region; such a region is not a result of the scene.
    only_step : int, optional
        Number of the only step whose fields are stored; by default those of all steps. In the other steps observers
        that read the region have it computed.

    Raises
    ------
    SceneError
        No field has a cause in this region.
    """

    numbers: Sequence[Number] = (
        Number(
            name="max_von_mises", unit="Pa", meaning="largest von Mises stress at the requested points", headline=True,
            label="largest von Mises stress",
        ),
        Number(
            name="max_von_mises_depth", unit="m", meaning="depth of the largest von Mises stress", headline=True,
            label="  at depth", of_points=True,
        ),
    )  # fmt: skip

    def __init__(
        self, request: StressRequest, lattice: RegionLattice, causes: CausesOf, interface: Interface | None,
        requester: str = "", only_step: int | None = None,
    ) -> None:  # fmt: skip
        self.numbers = Region.numbers if not requester and "stress" in request.fields else ()
        self.request, self.lattice, self.causes, self.interface = request, lattice, causes, interface
        self.stored, self.only_step, label = not requester, only_step, request.label
        self.name = f"stress-{label}"
        self.reason = f"{requester or '[[stress]]'} asks for {request.shape} {label!r} in body {request.body}"
        self.provides = frozenset({f"stress:{label}"})
        self.requesters = {f"stress:{label}": f"[[stress]] {label!r}"} if self.stored else {}
        parts = list(causes(interface))
        if not parts:
            raise SceneError(
                f"stress region {label!r} must lie in a body with eigenstrain (body{request.body} has none, "
                "and there is no contact); set body"
            )
        self.requires = frozenset().union(*(cause.requires for cause in parts))
        self.kernels = [kernel for cause in parts for kernel in cause.kernels]
        note = "; ".join(cause.note for cause in parts if cause.note)
        self.reason += f"; {note}" if note else ""
        self.cost = sum((cause.cost for cause in parts), Cost())
        self.precisions = [precision for cause in parts for precision in cause.precisions]
        #: Whether `eigencontact.execution.fields.stress_of_steps` computes the stress after the run.
        self.by_depths = all(cause.by_depths for cause in parts) and "strain" not in request.fields

    def of_step(self, number: int) -> Region:
        """Region that is stored after one step alone."""
        return Region(self.request, self.lattice, self.causes, self.interface, only_step=number)

    def start(self, run: Run) -> Running:  # noqa: ARG002
        """See `Block.start`."""
        return RunningRegion(self)


class RunningRegion:
    """Running block of a region, with the operators of its causes."""

    def __init__(self, region: Region) -> None:
        self._region, self._interface = region, region.interface
        self._causes = list(region.causes(region.interface))

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        if self._region.only_step not in (None, step.index):
            step.looks[self._region.request.label] = lambda: self._record(step)[0]
            return
        record, stress = self._record(step)
        (step.regions if self._region.stored else step.looks)[record.name] = record
        if self._region.stored and stress is not None:
            note_largest(step, record, stress)

    def _record(self, step: Step) -> tuple[RegionRecord, FloatArray | None]:
        """Fields for storage after a step, and the stress."""
        fields: dict[str, FloatArray] = {}
        solids, interface = step.surface.solids, self._interface
        if solids is not None and interface is not None and solids != interface.solids:
            self._interface = replace(interface, solids=solids)
            self._causes = list(self._region.causes(self._interface))
        for cause in self._causes:
            for quantity, values in cause.fields(step).items():
                fields[quantity] = fields[quantity] + values if quantity in fields else values
        for cause in self._causes:
            cause.amend(fields, step)
        record, stress = region_record(self._region.request, self._region.lattice, fields)
        record = replace(
            record,
            note="; ".join(cause.note for cause in self._causes if cause.note),
            mean_above=max(cause.mean_above for cause in self._causes),
        )
        return record, stress


def region_of(model: Model, request: StressRequest, requester: str = "") -> Region:
    """Region of a request in a model."""
    lattice = region_lattice(request, model.grid)

    def causes(interface: Interface | None) -> Iterator[Cause]:
        if interface is not None:
            from eigencontact.execution.fields.traction_field import TractionField, moves

            moving = moves(model.scene.ramps)
            yield TractionField(interface, model.window, model.numerics, request, lattice, moves=moving)
        if any(name in model.scene.bulk_at_rest for name in BULK_NAMES[request.body]):
            from eigencontact.execution.fields.bulk_field import BulkField

            solid = (model.bodies.solids if interface is None else interface.solids)[request.body - 1]
            assert solid is not None
            yield BulkField(request, lattice, solid, model.grid)
        if any(source.body == request.body for source in model.sources):
            from eigencontact.execution.fields.eigenstrain_field import EigenstrainField
            from eigencontact.execution.routes.subsurface import subsurfaces_of

            for subsurface in subsurfaces_of(model):
                if subsurface.body == request.body:
                    yield EigenstrainField(subsurface, request, lattice)

    return Region(request, lattice, causes, model.interface, requester)


def regions_of(model: Model) -> Iterator[Region]:
    """All stress regions of the scene."""
    return (region_of(model, request) for request in model.cells.requests)


def region_record(
    request: StressRequest, lattice: RegionLattice, fields: Mapping[str, FloatArray]
) -> tuple[RegionRecord, FloatArray | None]:
    """Record of a region for storage, with the requested fields and scalars; and the stress.

    Parameters
    ----------
    fields : mapping of str to array
        ``stress`` and ``strain`` as Mandel vectors ``(6, ...)``, ``displacement (3, ...)``, on the points of `lattice`.
    """
    stress: FloatArray | None = None
    stored: dict[str, FloatArray] = {}
    for name in request.fields:
        values = _cut(fields[name], request)
        stored[name] = values if name == "displacement" else from_mandel(values)
    if "stress" in request.fields:
        stress = _cut(fields["stress"], request)
        stored |= {name: _SCALARS[name](stress) for name in request.quantities}
    return _record(request, lattice, stored), stress


def note_largest(step: Step, record: RegionRecord, stress: FloatArray) -> None:
    """Note the largest von Mises stress of all regions of a step, and its depth."""
    mises = record.fields["von_mises"] if "von_mises" in record.fields else von_mises(stress)
    where = int(np.argmax(mises))
    largest = float(mises.flat[where])
    if largest >= step.scalars.get("max_von_mises", -1.0):
        depth = np.broadcast_to(_depth_of(record), mises.shape).flat[where]
        step.scalars["max_von_mises"], step.scalars["max_von_mises_depth"] = largest, float(depth)


def _cut(values: FloatArray, request: StressRequest) -> FloatArray:
    """Remove the axis of length one of a plane."""
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
