"""Blocks for a contact: initial gap, tangential displacement, closed forms."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.convolution import Layout
from eigencontact.core.grid import Grid
from eigencontact.core.numbers import Number
from eigencontact.execution.blocks.block import Block, Run, Running, Stateless
from eigencontact.execution.blocks.precision import plane_round_off, settled
from eigencontact.execution.blocks.sampling import sampling_seconds, spectra_cost, tables_of_images
from eigencontact.execution.blocks.step import Step
from eigencontact.model.bodies import layered_bodies, without_layers
from eigencontact.model.interface import Interface
from eigencontact.model.kernels import KernelUse, Solids
from eigencontact.model.model import Model
from eigencontact.plugin import HasReferencePressure
from eigencontact.plugin.revolution import RevolutionSum
from eigencontact.scene.holding import TRAVEL
from eigencontact.scene.schema import Numerics

if TYPE_CHECKING:
    from eigencontact.convolution import Convolver

__all__ = [
    "ReferencePressure",
    "Separation",
    "TangentialDisplacement",
    "blocks_beside_contact",
    "separation_blocks",
]


#: Cells per evaluation of a closed form: its temporary arrays stay in the cache.
_BAND = 2**17


class Separation(Block):
    """Initial gap; if the geometry rolls or slides, at its present position, and stored.

    Parameters
    ----------
    interface : Interface
        Interface; the separations of its geometries are added.
    grid : Grid
    travels : bool
        Whether the geometry moves along the surface.
    slides : bool, optional
        Whether the moving geometry slides; by default if there is friction.
    """

    name = "separation"
    provides = frozenset({"separation"})
    settles = True
    numbers = tuple(
        Number(name=f"travel_{axis}", unit="m", meaning=f"place of the geometry along {axis}") for axis in "xy"
    )

    def __init__(self, interface: Interface, grid: Grid, *, travels: bool, slides: bool | None = None) -> None:
        self._interface, self._grid, self._travels = interface, grid, travels
        slides = interface.friction is not None if slides is None else slides
        self.reason = "the initial gap of the geometry " + " + ".join(geometry.key for geometry in interface.geometries)
        self.reason += f", which {'slides' if slides else 'rolls'} along the surface" if travels else ""
        self.numbers = Separation.numbers if travels else ()

    def start(self, run: Run) -> Running:  # noqa: ARG002
        """See `Block.start`."""
        return _TravellingGap(self._interface, self._grid, travels=self._travels)


class _TravellingGap:
    """Initial gap at the present position of the geometry, computed when the position changes."""

    def __init__(self, interface: Interface, grid: Grid, *, travels: bool) -> None:
        self._interface, self._grid, self._travels = interface, grid, travels
        self._place: tuple[float, float] | None = None
        self._separation = np.empty(0)

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        if step.travel != self._place:
            y, x = self._grid.axes()
            self._separation = self._interface.separation(x - step.travel[0], y - step.travel[1])
            self._place = step.travel
        step.surface = replace(step.surface, separation=self._separation)
        if self._travels:
            step.scalars |= dict(zip(TRAVEL, step.travel, strict=True))


class TangentialDisplacement(Block):
    """Displacement along the surface by the pressure."""

    name, reason = "tangential-displacement", "output.tangential-displacement = true"
    requires = frozenset({"pressure"})
    provides = frozenset({"displacement_x", "displacement_y"})
    requesters = dict.fromkeys(("displacement_x", "displacement_y"), "output.tangential-displacement")

    def __init__(self, interface: Interface, grid: Grid, numerics: Numerics) -> None:
        self._grid, periodic = grid, numerics.boundary == "periodic"
        self._numerics, self.precisions = settled(numerics, self.name, plane_round_off)
        self._pairs = [interface.pair(component, "z") for component in "xy"]
        self._layout = Layout(grid.shape, grid.shape, periodic=periodic)
        key, solids = interface.kernel_key("z"), [body for body in interface.solids if body is not None]
        self.kernels = tuple(KernelUse(f"displacement {c}", "pressure p", key, "surface, whole window") for c in "xy")
        sampling = max(sampling_seconds(interface.influences["p"], body, periodic=periodic) for body in solids)
        sampling *= tables_of_images(numerics)
        self.cost = spectra_cost(self._layout, 1, sampling, self._numerics, kernels=2)

    def start(self, run: Run) -> Running:  # noqa: ARG002
        """See `Block.start`."""
        from eigencontact.convolution import Convolver

        layout, grid, precision = self._layout, self._grid, self._numerics.precision
        kernels = []
        for pair in self._pairs:
            if layout.periodic:
                ky, kx = layout.wavenumbers(grid.dy, grid.dx)
                response = pair.response(kx[None, :], ky[:, None])
                spectrum = layout.spectrum_from_response(response, pair.parity, precision=precision)
            else:
                table = pair.table(layout.x.lattice * grid.dx, layout.y.lattice * grid.dy, grid.half_widths)
                spectrum = layout.spectrum(table, pair.parity, precision=precision)
            kernels.append([spectrum])
        return _ConvolvedPressure(Convolver(layout, precision=precision, threads=self._numerics.threads), kernels)


class _ConvolvedPressure:
    """Displacement along the surface as a convolution of the pressure."""

    def __init__(self, convolver: Convolver, kernels: list[list[Any]]) -> None:
        self._convolver, self._kernels = convolver, kernels

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        values = self._convolver.apply(step.fields["pressure"][None], self._kernels)
        step.fields["displacement_x"], step.fields["displacement_y"] = np.asarray(values, dtype=float)


class ReferencePressure(Stateless):
    """Closed form of the pressure, if the geometry has one that is valid for this step.

    For a body with layers, inclusions or eigenstrain it is the pressure without them, stored under another name.

    Parameters
    ----------
    geometry : HasReferencePressure
    key : str
        Name of the geometry.
    grid : Grid
    solids : Solids
    simpler : str
        Phrase for the features that the closed form neglects; empty if there are none.
    """

    requires = frozenset({"pressure"})

    def __init__(self, geometry: HasReferencePressure, key: str, grid: Grid, solids: Solids, simpler: str) -> None:
        from eigencontact.core.material import contact_modulus

        self.name = "homogeneous-pressure" if simpler else "reference-pressure"
        self.reason = f"geometry {key!r} has a closed form {simpler}".rstrip() + ", drawn beside the result"
        self._field = self.name.replace("-", "_")
        self.provides, self.requesters = frozenset({self._field}), {self._field: "pictures"}
        self._grid, self._geometry = grid, geometry
        self._modulus = contact_modulus(*without_layers(solids))

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        if step.scalars["normal_load"] <= 0 or step.scalars["tilt_x"] or step.scalars["tilt_y"]:
            return
        y, x = self._grid.axes()
        x, y = x - step.travel[0], y - step.travel[1]
        field = np.empty(self._grid.shape)
        rows = max(1, _BAND // self._grid.nx)
        for at in range(0, self._grid.ny, rows):
            band = slice(at, at + rows)
            field[band] = self._geometry.reference_pressure(x, y[band], step.scalars["normal_load"], self._modulus)
        step.fields[self._field] = field


def separation_blocks(model: Model, gap: Separation | None = None) -> Iterator[Block]:
    """Blocks of the gap, by default of new surfaces, and of the material at the surface."""
    assert model.interface is not None
    yield gap or Separation(model.interface, model.grid, travels=any(ramp.travels for ramp in model.scene.ramps))
    if model.exposed is not None:
        from eigencontact.execution.mechanics.exposed_material import ExposedMaterial

        yield ExposedMaterial(model.exposed)


def blocks_beside_contact(model: Model) -> Iterator[Block]:
    """Blocks of a contact other than its mechanics and its gap."""
    interface, grid = model.interface, model.grid
    if interface is None:
        return
    friction, numerics = interface.friction, model.numerics
    if model.scene.output.tangential_displacement and friction is None:
        yield TangentialDisplacement(interface, grid, numerics)
    first, *more = interface.geometries
    geometry: object = RevolutionSum.of(interface.geometries) if more else first
    reference = None
    if not (model.scene.losses or model.periodic or grid.ended_axes != (0, 1)) and isinstance(
        geometry, HasReferencePressure
    ):
        simpler = "without inclusions and eigenstrain" if model.sources else ""
        simpler = "on the bare substrate" if layered_bodies(interface.solids) else simpler
        reference = ReferencePressure(geometry, first.key, grid, interface.solids, simpler)
        yield reference
    if friction is not None:
        from eigencontact.execution.mechanics.friction_reference import ReferenceShear, ShearBound

        yield ShearBound(friction, grid, model.exposed)
        exact = reference is not None and reference.name == "reference-pressure"
        uncoupled = not (interface.coupling.joins_normal or model.scene.bulk_at_rest)
        if exact and isinstance(geometry, HasReferencePressure) and uncoupled:
            yield ReferenceShear(geometry, first.key, grid, interface.solids)
