"""Blocks beside the mechanics of a contact: initial gap, displacement along the surface, closed forms."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution import Layout
from eigencontact.core.grid import Grid
from eigencontact.core.numbers import Number
from eigencontact.execution.blocks.block import Block, Run, Running, Stateless
from eigencontact.execution.blocks.precision import plane_round_off, settled
from eigencontact.execution.blocks.sampling import sampling_seconds, spectra_cost
from eigencontact.execution.blocks.step import Step
from eigencontact.model.bodies import kernel_key, layered_bodies, without_layers
from eigencontact.model.kernels import Bodies, KernelUse, PairCoefficients
from eigencontact.model.model import Model
from eigencontact.model.separation import sum_separations
from eigencontact.plugin import Geometry, HasReferencePressure, SurfaceInfluence
from eigencontact.plugin.revolution import RevolutionSum
from eigencontact.scene.holding import TRAVEL
from eigencontact.scene.schema import Numerics

if TYPE_CHECKING:
    from eigencontact.convolution import Convolver

__all__ = ["ReferencePressure", "Separation", "TangentialDisplacement", "blocks_beside_contact"]

FloatArray = NDArray[np.float64]

#: Cells of which a closed form is evaluated at a time: what it needs besides its result stays in the cache.
_BAND = 2**17


class Separation(Block):
    """The initial gap; where the geometry rolls or slides, at the place that it has reached, which is stored.

    Parameters
    ----------
    geometries : sequence of Geometry
        Their separations add up.
    grid : Grid
    motion : str
        Verb for the geometry that moves along the surface; empty where it stays.
    """

    name = "separation"
    provides = frozenset({"separation"})
    settles = True
    numbers = tuple(
        Number(name=f"travel_{axis}", unit="m", meaning=f"place of the geometry along {axis}") for axis in "xy"
    )

    def __init__(self, geometries: Sequence[Geometry], grid: Grid, motion: str) -> None:
        self._geometries, self._grid, self._travels = geometries, grid, bool(motion)
        self.why = "the initial gap of the geometry " + " + ".join(geometry.key for geometry in geometries)
        self.why += f", which {motion} along the surface" if motion else ""
        self.numbers = Separation.numbers if motion else ()

    def start(self, run: Run) -> Running:  # noqa: ARG002
        """See `Block.start`."""
        return _TravellingGap(self._geometries, self._grid, travels=self._travels)


class _TravellingGap:
    """The initial gap at the place that the geometry has reached; it is computed where the place changes."""

    def __init__(self, geometries: Sequence[Geometry], grid: Grid, *, travels: bool) -> None:
        self._geometries, self._grid, self._travels = geometries, grid, travels
        self._place: tuple[float, float] | None = None
        self._separation = np.empty(0)

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        if step.travel != self._place:
            y, x = self._grid.axes()
            self._separation = sum_separations(self._geometries, x - step.travel[0], y - step.travel[1])
            self._place = step.travel
        step.surface = replace(step.surface, separation=self._separation)
        if self._travels:
            step.scalars |= dict(zip(TRAVEL, step.travel, strict=True))


class TangentialDisplacement(Block):
    """Displacement along the surface under the pressure."""

    name, why = "tangential-displacement", "output.tangential-displacement = true"
    requires = frozenset({"pressure"})
    provides = frozenset({"displacement_x", "displacement_y"})
    wanted = dict.fromkeys(("displacement_x", "displacement_y"), "output.tangential-displacement")

    def __init__(self, grid: Grid, influence: SurfaceInfluence, solids: Bodies, numerics: Numerics) -> None:
        self._grid, periodic = grid, numerics.boundary == "periodic"
        self._numerics, self.precisions = settled(numerics, self.name, plane_round_off)
        self._pairs = [PairCoefficients(influence, solids, component) for component in "xy"]
        self._layout = Layout(grid.shape, grid.shape, periodic=periodic)
        key = kernel_key(influence, solids)
        self.kernels = tuple(KernelUse(f"displacement {c}", "pressure p", key, "surface, whole window") for c in "xy")
        sampling = max(sampling_seconds(influence, body, periodic=periodic) for body in solids if body is not None)
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
                half_widths = (0.5 * grid.dx, 0.5 * grid.dy)
                table = pair.table(layout.x.lattice * grid.dx, layout.y.lattice * grid.dy, half_widths)
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
    """Closed form of the pressure, where the geometry has one that holds for this step.

    For a body with layers, inclusions or eigenstrain it is that without them, and stored under another name.

    Parameters
    ----------
    geometry : HasReferencePressure
    key : str
        Name of the geometry.
    grid : Grid
    bodies : Bodies
    simpler : str
        Phrase for what the closed form leaves out; empty where it leaves out nothing.
    """

    requires = frozenset({"pressure"})

    def __init__(self, geometry: HasReferencePressure, key: str, grid: Grid, bodies: Bodies, simpler: str) -> None:
        from eigencontact.core.material import contact_modulus

        self.name = "homogeneous-pressure" if simpler else "reference-pressure"
        self.why = f"geometry {key!r} has a closed form {simpler}".rstrip() + ", drawn beside the result"
        self._field = self.name.replace("-", "_")
        self.provides, self.wanted = frozenset({self._field}), {self._field: "pictures"}
        self._grid, self._geometry = grid, geometry
        self._modulus = contact_modulus(*without_layers(bodies))

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


def blocks_beside_contact(model: Model, *, new_surfaces: bool) -> Iterator[Block]:
    """Blocks of a contact besides its mechanics; without `new_surfaces` another block gives the separation."""
    if not model.geometries:
        return
    if new_surfaces:
        motion = "rolls" if model.friction is None else "slides"
        travels = any(ramp.travels for ramp in model.scene.ramps)
        yield Separation(model.geometries, model.grid, motion if travels else "")
        if model.exposed is not None:
            from eigencontact.execution.mechanics.exposed_material import ExposedMaterial

            yield ExposedMaterial(model.exposed)
    if model.scene.output.tangential_displacement and model.friction is None:
        yield TangentialDisplacement(model.grid, model.influences["p"], model.bodies, model.numerics)
    alone = len(model.geometries) == 1
    geometry: object = model.geometries[0] if alone else RevolutionSum.of(model.geometries)
    key, reference = model.geometries[0].key, None
    if new_surfaces and not model.periodic and isinstance(geometry, HasReferencePressure):
        simpler = "without inclusions and eigenstrain" if model.sources else ""
        simpler = "on the bare substrate" if layered_bodies(model.bodies) else simpler
        reference = ReferencePressure(geometry, key, model.grid, model.bodies, simpler)
        yield reference
    if model.friction is not None:
        from eigencontact.execution.mechanics.friction_reference import ReferenceShear, ShearBound

        yield ShearBound(model.friction, model.grid, model.exposed)
        assert model.coupling is not None
        exact = reference is not None and reference.name == "reference-pressure"
        if exact and isinstance(geometry, HasReferencePressure) and not model.coupling.joins_normal:
            yield ReferenceShear(geometry, key, model.grid, model.bodies)
