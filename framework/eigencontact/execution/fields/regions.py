"""Fields at the points of a region, by tractions and by eigenstrain, and what is read off them, as they are stored."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.numbers import Number
from eigencontact.core.tensors import from_mandel, hydrostatic, principal, tresca, von_mises
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.block import Block, Cost, Run, Running
from eigencontact.execution.blocks.precision import Precision
from eigencontact.execution.blocks.step import Step
from eigencontact.model.kernels import KernelUse
from eigencontact.model.model import Model
from eigencontact.model.regions import RegionLattice, region_lattice
from eigencontact.results.records import RegionRecord
from eigencontact.scene.schema import StressRequest

__all__ = ["Region", "RunningRegion", "regions_of"]

FloatArray = NDArray[np.float64]

_SCALARS: dict[str, Callable[[FloatArray], FloatArray]] = {
    "von_mises": von_mises,
    "tresca": tresca,
    "principal": principal,
    "hydrostatic": hydrostatic,
}


class Region(Block):
    """Fields wanted at the points of one region: by the tractions of a contact, and by all eigenstrain of its body.

    A step is enough to evaluate it: tractions are its surface fields, the eigenstrain of inhomogeneities its history.

    Parameters
    ----------
    model : Model
    request : StressRequest
        With the places that it stands for.
    asker : str, optional
        Who wants to see it in each step, if it is no result of the scene.

    Raises
    ------
    SceneError
        Nothing causes a field there.
    """

    numbers: Sequence[Number] = (
        Number(
            name="max_von_mises", unit="Pa", meaning="largest von Mises stress at the requested points", headline=True,
            label="largest von Mises stress",
        ),
        Number(
            name="max_von_mises_depth", unit="m", meaning="depth of the largest von Mises stress", headline=True,
            label="  at depth",
        ),
    )  # fmt: skip

    def __init__(self, model: Model, request: StressRequest, asker: str = "") -> None:
        self.numbers = Region.numbers if not asker and "stress" in request.fields else ()
        self._request, self._lattice, label = request, region_lattice(request, model.grid), request.label
        self._model = model
        self.name = f"stress-{label}"
        self._stored = not asker
        self.why = f"{asker or '[[stress]]'} asks for {request.shape} {label!r} in body {request.body}"
        self.provides = frozenset({f"stress:{label}"})
        self.wanted = {f"stress:{label}": f"[[stress]] {label!r}"} if self._stored else {}
        causes = list(_causes(model, request, self._lattice))
        if not causes:
            raise SceneError(
                f"stress region {label!r} must lie in a body with eigenstrain (body{request.body} has none, "
                "and there is no contact); set body"
            )
        self.requires = frozenset().union(*(cause.requires for cause in causes))
        self.kernels = [kernel for cause in causes for kernel in cause.kernels]
        note = "; ".join(cause.note for cause in causes if cause.note)
        self.why += f"; {note}" if note else ""
        self.cost = sum((cause.cost for cause in causes), Cost())
        self.precisions = [precision for cause in causes for precision in cause.precisions]

    def start(self, run: Run) -> Running:  # noqa: ARG002
        """See `Block.start`."""
        return RunningRegion(self._model, self._request, self._lattice, stored=self._stored)


class RunningRegion:
    """Fields of a region in one run, with causes that hold operators."""

    def __init__(self, model: Model, request: StressRequest, lattice: RegionLattice, *, stored: bool) -> None:
        self._model, self._request, self._lattice, self._stored = model, request, lattice, stored
        self._bodies, self._causes = model.bodies, list(_causes(model, request, lattice))

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        fields: dict[str, FloatArray] = {}
        bodies = step.surface.bodies
        if bodies is not None and bodies != self._bodies:
            self._bodies = bodies
            self._causes = list(_causes(replace(self._model, bodies=self._bodies), self._request, self._lattice))
        for cause in self._causes:
            for quantity, values in cause.fields(step).items():
                fields[quantity] = fields[quantity] + values if quantity in fields else values
        for cause in self._causes:
            cause.amend(fields, step)
        record, stress = region_record(self._request, self._lattice, fields)
        record = replace(
            record,
            note="; ".join(cause.note for cause in self._causes if cause.note),
            mean_above=max(cause.mean_above for cause in self._causes),
        )
        (step.regions if self._stored else step.looks)[record.name] = record
        if self._stored and stress is not None:
            note_largest(step, record, stress)


class Cause(Protocol):
    """Something that causes a field at the points of a region."""

    @property
    def requires(self) -> frozenset[str]:
        """Quantities that it needs of a step."""
        ...

    @property
    def kernels(self) -> Sequence[KernelUse]:
        """Influence coefficients that it builds."""
        ...

    @property
    def cost(self) -> Cost:
        """Price of them, and of a step."""
        ...

    @property
    def precisions(self) -> Sequence[Precision]:
        """See `Part`."""
        ...

    @property
    def note(self) -> str:
        """What must be known of its values, in words, or nothing."""
        ...

    @property
    def mean_above(self) -> float:
        """Depth [m] above which its stress is a mean over each cell; 0 where none is."""
        ...

    def fields(self, step: Step) -> dict[str, FloatArray]:
        """Its fields by quantity, ``(3 or 6, *lattice.shape)``."""
        ...

    def amend(self, fields: dict[str, FloatArray], step: Step) -> None:
        """Change the sum of all causes where more is known of it."""
        ...


def _causes(model: Model, request: StressRequest, lattice: RegionLattice) -> Iterator[Cause]:
    if model.geometries:
        from eigencontact.execution.fields.traction_field import TractionField

        yield TractionField(model, request, lattice)
    if any(source.body == request.body for source in model.sources):
        from eigencontact.execution.fields.eigenstrain_field import EigenstrainField

        yield EigenstrainField(model, request, lattice)


def regions_of(model: Model) -> Iterator[Region]:
    """Every region that the scene asks for."""
    return map(partial(Region, model), model.requests)


def region_record(
    request: StressRequest, lattice: RegionLattice, fields: Mapping[str, FloatArray]
) -> tuple[RegionRecord, FloatArray | None]:
    """Region as it is stored: the fields asked for, and with the stress the numbers read off it; and that stress.

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
