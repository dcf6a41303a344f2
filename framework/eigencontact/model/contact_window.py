"""Window of a contact, chosen by coarse solves of its load history."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial, reduce
from typing import Any, NamedTuple

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid, MakeGrid
from eigencontact.errors import PlanError, SceneError
from eigencontact.model.bodies import without_layers
from eigencontact.model.interface import Interface
from eigencontact.model.kernels import PairCoefficients
from eigencontact.model.resolution import refuse_coarse
from eigencontact.model.sizes import cut_down, most, refuse_more
from eigencontact.model.window import Window, given_grid
from eigencontact.plugin import HasNativeGrid
from eigencontact.scene.holding import held_steps, held_travel
from eigencontact.scene.schema import GridSpec, Scene
from eigencontact.scene.spacing import spaced_by_radius
from eigencontact.scene.steps import named_ramps
from eigencontact.solvers.coarse_contact import Separation, close_estimate, estimate_contact, settled_estimate
from eigencontact.solvers.contact_estimate import ContactEstimate
from eigencontact.solvers.contact_growth import ContactGrowth, contact_growth
from eigencontact.solvers.control import Control
from eigencontact.solvers.operator import Coefficients

__all__ = ["contact_window", "contacts_of_steps"]


#: Share of the window that a contact takes at least where a coarse solve over all of it shows its size.
_PLAIN = 0.3
#: Cells around the estimate of a contact, which itself is larger by some coarse cells.
_AROUND = 4


def contact_window(scene: Scene, interface: Interface) -> Window:
    """Window of a contact without eigenstrain and inclusions."""
    grid, reason = _grid(scene, interface)
    grid = replace(grid, repeats_y=scene.numerics.repeats_y)
    interface = interface.against(grid.size[0])
    normal, measured = interface.normal, interface.measured
    whole = ContactEstimate(-0.5 * grid.size[0], 0.5 * grid.size[0], -0.5 * grid.size[1], 0.5 * grid.size[1])
    contacts = contacts_of_steps(scene, grid, interface)
    touched = reduce(ContactEstimate.join, [step.contact for step in contacts]) if contacts else whole
    box = tuple(
        _box_size(extent / edge, size)
        for extent, edge, size in zip(touched.extent[::-1], (grid.dy, grid.dx), grid.shape, strict=True)
    )
    expected = _expected(contacts, grid, normal)
    if expected is not None and not (measured or scene.numerics.allow_coarse):
        refuse_coarse(expected, grid)
    growth = None if measured else _growth(scene, contacts, grid)
    _refuse_radius(scene, growth)
    return Window(grid=grid, reason=reason, box=(box[0], box[1]), expected=expected, growth=growth)


def _box_size(cells: float, size: int) -> int:
    """Number of cells along one side of the box of a contact, by a coarse estimate.

    A contact in the middle of the window has an even number of cells where the window has. Half of the coefficients are
    images of the others then, and the price halves.
    """
    box = int(np.ceil(cells)) + _AROUND
    return min(size, box + (size - box) % 2)


def _controls(scene: Scene) -> list[Control]:
    """Control at the end of each ramp."""
    steps = held_steps(scene.ramps) if scene.friction is not None else scene.ramps
    names = ("normal_load", "approach", "moment_x", "tilt_x", "moment_y", "tilt_y")
    return [Control(**{name: getattr(step, name) for name in names}) for step in steps]


def _grid(scene: Scene, interface: Interface) -> tuple[Grid, str]:
    """Grid of the scene, of a geometry, or fitted to the largest contact; and its origin in words."""
    spec, geometries, normal = scene.grid, interface.geometries, interface.normal
    scene_grid = given_grid(spec)
    if scene_grid is not None:
        return scene_grid, "given in the scene"
    native = next((geometry for geometry in geometries if isinstance(geometry, HasNativeGrid)), None)
    if native is not None:
        cells = native.native_grid()
        grid = spec.with_cells(cells.nx, cells.ny, cells.dx, cells.dy, cells.center)
        return grid, f"the grid that the geometry {native.key!r} brings"
    if scene.numerics.boundary == "periodic":
        raise SceneError(
            "grid must be given for a periodic scene (got automatic); its size is the period: give cells and size"
        )
    pairs = zip(_controls(scene), held_travel(scene.ramps), strict=True)
    touching = (pair for pair in pairs if 0.0 not in (pair[0].normal_load, pair[0].approach))
    controls = list(dict.fromkeys(touching))  # steps of a fretting cycle have one load
    # The search for a first window takes cells of a hundred sizes: it leaves layers out.
    bare = PairCoefficients(normal.influence, without_layers(normal.bodies), "z")
    first_window = partial(_first_window, interface.separation, bare, cells=spec.with_cells)
    start = max((first_window(control) for control in dict.fromkeys(control for control, _ in controls)), default=1.0)
    yields = scene.body1.law is not None or scene.body2.law is not None
    grid = _automatic_grid(spec, interface.separation, normal, controls, start, odd=yields)
    return grid, f"automatic: {spec.cells_per_contact_radius:g} cells per contact radius, margin {spec.margin:g}"


def _first_window(separation: Any, normal: PairCoefficients, control: Control, *, cells: MakeGrid) -> float:
    """Side of a square window, or width of one of a line contact, from a balance of load and separation [m].

    Found to round-off, so that a scene scaled in length gets the same grid scaled.
    """
    bottom = float(separation(np.zeros(1), np.zeros(1))[0])

    def rises(side: float) -> bool:
        ring = np.array([0.5, -0.5, 0.0, 0.0]) * side
        h = separation(ring, ring[::-1].copy())
        if control.normal_load is not None:
            cell = cells(1, 1, side, side, (0.0, 0.0))
            # Of a strip against the end of the window: its displacement has a free constant.
            places = np.zeros(1) if 1 in cell.bounded_axes else np.array([0.0, 0.5 * side])
            middle, *end = normal.table(places, np.zeros(1), cell.half_widths)[0]
            lift = (middle - sum(end)) * control.normal_load / cell.cell_area
        else:
            lift = abs(control.approach or 0.0)
        return float(np.min(h)) - bottom > float(lift) > 0.0

    low = next((2.0**exponent for exponent in range(-41, 15) if rises(2.0 ** (exponent + 1))), None)
    if low is None:
        return 1.0
    high = 2.0 * low
    while high - low > 1e-14 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if rises(middle) else (middle, high)
    return 2.0 * high


def _automatic_grid(
    spec: GridSpec,
    separation: Separation,
    coefficients: Coefficients,
    controls: Sequence[tuple[Control, tuple[float, float]]],
    start: float,
    *,
    odd: bool,
) -> Grid:
    """Grid with the cells per contact radius of a table, for the largest contact of a load history.

    Parameters
    ----------
    controls : sequence of (Control, (float, float))
        End of each step, and the place (x, y) [m] to which the geometry has rolled by then.
    start : float
        A first guess of the window's side [m]; windows are enlarged or cut until the contact fills about half.
    odd : bool
        With a cell in the middle of the contact: there the print of a contact that yields is read with half the error.

    Raises
    ------
    PlanError
        Where no window holds the contact (no load, a geometry without rise).
    SceneError
        More cells than the memory of this machine can hold.
    """
    largest: ContactEstimate | None = None
    across = 0.0

    @cache  # steps that slide under one load have one contact
    def estimated(control: Control) -> ContactEstimate | None:
        return settled_estimate(spec.center, separation, coefficients, control, start, spec.with_cells)

    for control, travel in controls:
        estimate = estimated(control)
        if estimate is not None:
            across = max(across, min(estimate.extent))
            estimate = estimate.moved(travel)
            largest = estimate if largest is None else largest.join(estimate)
    rolls = any(travel != (0.0, 0.0) for _, travel in controls)
    if largest is None:
        raise PlanError(
            "grid must be given for this scene (got automatic); no step makes a contact from which cells could be "
            "chosen: give grid.cells and grid.size, or a load"
        )
    wide, high = largest.extent
    edge = 0.5 * (across if rolls else min(wide, high)) / spec.cells_per_contact_radius
    center = (0.5 * (largest.x0 + largest.x1), 0.5 * (largest.y0 + largest.y1))
    # Symmetric about the contact; an even number of cells halves the price of coefficients.
    nx, ny = (2 * max(1, int(np.ceil(0.5 * spec.margin * extent / edge - 1e-6))) + odd for extent in (wide, high))
    # A centre within a cell of the origin is the origin: symmetric scenes stay symmetric.
    center = tuple(0.0 if abs(value) < 0.06 * max(wide, high) else value for value in center)  # type: ignore[assignment]
    grid = spec.with_cells(nx, ny, edge, edge, center)
    _refuse_many(grid.nx * grid.ny, spec)
    return grid


def _refuse_many(cells: int, spec: GridSpec) -> None:
    """Refuse too many cells; name the margin if the usual margin would fit, otherwise the cells per radius."""
    usual = GridSpec.model_fields["margin"].default
    wide = spec.margin > usual and cells * (usual / spec.margin) ** 2 <= most()
    name = "margin" if wide else "cells_per_contact_radius"
    setting = getattr(spec, name)
    where = f"grid.{name.replace('_', '-')}"
    refuse_more(cells, where, "cells", f"{setting:g}", f"{cut_down(setting, cells, 2):g} would do")


class StepContact(NamedTuple):
    """Estimated contact at the end of a load step, with its control and separation."""

    contact: ContactEstimate
    control: Control
    separation: Separation

    @property
    def width(self) -> float:
        """Narrower side of the contact [m]."""
        return min(self.contact.extent)


def contacts_of_steps(scene: Scene, grid: Grid, interface: Interface) -> list[StepContact]:
    """Contacts of the load steps on coarse cells over the whole window; steps without contact are left out."""
    pairs = list(zip(_controls(scene), held_travel(scene.ramps), strict=True))
    contacts = {pair: _contact_of_step(scene, grid, interface, *pair) for pair in dict.fromkeys(pairs)}
    return [contact for contact in map(contacts.__getitem__, pairs) if contact is not None]


def _contact_of_step(
    scene: Scene, grid: Grid, interface: Interface, control: Control, travel: tuple[float, float]
) -> StepContact | None:
    def separation(x: FloatArray, y: FloatArray) -> FloatArray:
        return interface.separation(x - travel[0], y - travel[1])

    periodic = scene.numerics.boundary == "periodic"
    contact = estimate_contact(grid, separation, interface.normal, control, periodic=periodic)
    return None if contact is None else StepContact(contact, control, separation)


def _growth(scene: Scene, contacts: Sequence[StepContact], grid: Grid) -> ContactGrowth | None:
    """Growth of the contact where a load step is even in its radius."""
    if not (contacts and any(spaced_by_radius(scene.steps, friction=scene.friction is not None))):
        return None
    largest = max(contacts, key=lambda step: step.width)
    growth = contact_growth(largest.separation, largest.contact, largest.control, grid)
    loaded = [step for step in contacts if step.control.normal_load]
    if growth is None or largest.control.normal_load is not None or not loaded:
        return growth
    # The largest contact has no load of its own: another step gives the scale of the loads.
    contact, control, _ = max(loaded, key=lambda step: step.width)
    at_contact = float(np.interp(0.5 * np.sqrt(np.prod(contact.extent)), growth.radius, growth.normal_load))
    assert control.normal_load is not None
    return replace(growth, normal_load=growth.normal_load * control.normal_load / at_contact)


def _refuse_radius(scene: Scene, growth: ContactGrowth | None) -> None:
    if growth is not None:
        return
    for where, step in named_ramps(scene.steps):
        if step.spacing == "radius" and step.increments > 1:
            raise SceneError(
                f"{where}.spacing must be 'even' unless the gap rises on all sides of one place (got 'radius', and a "
                "contact without one radius); leave it out"
            )


def _expected(contacts: Sequence[StepContact], grid: Grid, normal: PairCoefficients) -> ContactEstimate | None:
    """Largest contact; solved on finer cells if it covers only few cells of the window."""
    if not contacts:
        return None
    contact, control, separation = max(contacts, key=lambda step: step.width)
    if max(share / side for share, side in zip(contact.extent, grid.sides, strict=False)) > _PLAIN:
        return contact
    return close_estimate(grid, separation, normal, control) or contact
